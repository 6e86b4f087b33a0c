"""Who goes first: `priority` of the flows of a GRCN, by what they did.

The order stays as it is unless the figures are clear. A flow goes before its neighbour if

- it is **occasional**: it spoke in three phases or more, a tenth of the run at most, and
- the neighbour is **steady**: it spoke for half of the run or more, and
- the neighbour spoke during half of what the occasional one had to say, or more: as the plan stands
  its words are lost.

That is how a joystick and an emergency brake differ from a navigation. It is also how somebody
looks who wants to get in between: each such proposal is one to look at before the plan is used.
A node whose name says that it is there for safety is never put behind another; no name puts a node
before another.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from rtron.planning.coherence.grcn import RANKED
from rtron.planning.tuning.duration_fit import FEW
from rtron.planning.tuning.formatting import number, told
from rtron.planning.tuning.run_statistics import Note, of_flow
from rtron.vocabulary import (
    GRCN,
    SECOND,
    Flow,
    FlowFigures,
    Proposal,
    ProposalKind,
    StreamFigures,
    StreamKind,
)

LONG_ENOUGH = 60 * SECOND
_PHASES = 3
_OCCASIONAL, _STEADY = 10, 2
SAFETY = re.compile(
    r"safe|emerg|e_?stop|collision|bumper|brak|cliff|dead_?man|watchdog", re.IGNORECASE
)


def with_order(grcn: GRCN, stream: StreamFigures, duration: int, note: Note) -> GRCN:
    """Return a GRCN in which an occasional flow goes before a steady one that drowns it."""
    if grcn.policy not in RANKED or grcn.kind is not StreamKind.COMMAND or duration < LONG_ENOUGH:
        return grcn
    order = sorted(grcn.flows, key=lambda flow: -flow.priority)
    figures = {flow.name: of_flow(stream, flow) for flow in order}
    overtaken = dict(_overtaken(order, figures, duration))
    priorities = sorted((flow.priority for flow in order), reverse=True)
    given = {flow.name: new for flow, new in zip(order, priorities, strict=True)}
    for flow in grcn.flows:
        if given[flow.name] != flow.priority:
            why = _why(flow, overtaken.get(flow.name, ()), figures, duration)
            note(_changed(grcn.id, flow, given[flow.name], why, figures[flow.name]))
    flows = (replace(flow, priority=given[flow.name]) for flow in grcn.flows)
    return replace(grcn, flows=tuple(flows))


def _overtaken(
    order: list[Flow], figures: dict[str, FlowFigures], duration: int
) -> Iterator[tuple[str, tuple[Flow, ...]]]:
    """Put the flows in their new order; yield each that moved up with those it overtook."""
    for flow in tuple(order):
        passed = []
        at = order.index(flow)
        while at and _goes_before(figures[flow.name], figures[order[at - 1].name], duration):
            passed.append(order[at - 1])
            order[at - 1], order[at] = flow, order[at - 1]
            at -= 1
        if passed:
            yield flow.name, tuple(passed)


def _goes_before(one: FlowFigures, other: FlowFigures, duration: int) -> bool:
    occasional = _OCCASIONAL * one.active <= duration and one.pauses.count + 1 >= _PHASES
    steady = _STEADY * other.active >= duration
    lost = sum(each.duration for each in one.overlaps if each.flow == other.flow)
    drowned = one.messages >= FEW and lost > 0 and 2 * lost >= one.active
    return occasional and steady and drowned and not SAFETY.search(other.publisher)


def _why(flow: Flow, passed: Sequence[Flow], figures: dict[str, FlowFigures], duration: int) -> str:
    if not passed:
        return "it gives way to a flow that seldom speaks"
    own = figures[flow.name]
    others = ", ".join(
        f"{each.publisher} ({_share(figures[each.name], duration)} of the run)" for each in passed
    )
    names = {each.name for each in passed}
    lost = max(each.duration for each in own.overlaps if each.flow in names)
    return (
        f"{flow.publisher} spoke in {number(own.pauses.count + 1, 'phase')}, {told(own.active)} in "
        f"all ({_share(own, duration)} of the run), {told(lost)} of it in vain beside {others}; "
        f"right only if {flow.publisher} may interrupt"
    )


def _share(figures: FlowFigures, duration: int) -> str:
    percent = min(100 * figures.active / duration, 100)
    return f"{percent:.0f} %" if percent >= 1 else f"{percent:.1g} %"


def _changed(node: str, flow: Flow, new: int, why: str, figures: FlowFigures) -> Proposal:
    return Proposal(
        kind=ProposalKind.CHANGE,
        node=node,
        flow=flow.name,
        key="priority",
        before=str(flow.priority),
        after=str(new),
        why=why,
        samples=figures.messages,
    )
