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

from rtron.coherence.grcn import PRIORITY_POLICIES
from rtron.planning.tuning.formatting import count_text, short_duration
from rtron.planning.tuning.run_statistics import MIN_SAMPLES, AddProposal, flow_statistics
from rtron.vocabulary import (
    GRCN,
    SECOND,
    Flow,
    FlowStatistics,
    StreamKind,
    StreamStatistics,
    TuningProposal,
    TuningProposalKind,
)

MIN_RUN_DURATION = 60 * SECOND
_PHASES = 3
_OCCASIONAL, _STEADY = 10, 2
SAFETY_NAME = re.compile(
    r"safe|emerg|e_?stop|collision|bumper|brak|cliff|dead_?man|watchdog", re.IGNORECASE
)


def tune_priorities(grcn: GRCN, stream: StreamStatistics, duration: int, note: AddProposal) -> GRCN:
    """Return a GRCN in which an occasional flow goes before a steady one that drowns it."""
    if (
        grcn.policy not in PRIORITY_POLICIES
        or grcn.kind is not StreamKind.COMMAND
        or duration < MIN_RUN_DURATION
    ):
        return grcn
    order = sorted(grcn.flows, key=lambda flow: -flow.priority)
    figures = {flow.name: flow_statistics(stream, flow) for flow in order}
    overtaken = dict(_reorder(order, figures, duration))
    priorities = sorted((flow.priority for flow in order), reverse=True)
    new_priorities = {flow.name: new for flow, new in zip(order, priorities, strict=True)}
    for flow in grcn.flows:
        if new_priorities[flow.name] != flow.priority:
            why = _why(flow, overtaken.get(flow.name, ()), figures, duration)
            note(_changed(grcn.id, flow, new_priorities[flow.name], why, figures[flow.name]))
    flows = (replace(flow, priority=new_priorities[flow.name]) for flow in grcn.flows)
    return replace(grcn, flows=tuple(flows))


def _reorder(
    order: list[Flow], figures: dict[str, FlowStatistics], duration: int
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


def _goes_before(one: FlowStatistics, other: FlowStatistics, duration: int) -> bool:
    is_occasional = _OCCASIONAL * one.active <= duration and one.pauses.count + 1 >= _PHASES
    is_steady = _STEADY * other.active >= duration
    overlapped = sum(each.duration for each in one.overlaps if each.flow == other.flow)
    is_suppressed = one.messages >= MIN_SAMPLES and overlapped > 0 and 2 * overlapped >= one.active
    return is_occasional and is_steady and is_suppressed and not SAFETY_NAME.search(other.publisher)


def _why(
    flow: Flow, passed: Sequence[Flow], figures: dict[str, FlowStatistics], duration: int
) -> str:
    if not passed:
        return "it gives way to a flow that seldom speaks"
    statistics = figures[flow.name]
    others = ", ".join(
        f"{each.publisher} ({_share(figures[each.name], duration)} of the run)" for each in passed
    )
    names = {each.name for each in passed}
    overlapped = max(each.duration for each in statistics.overlaps if each.flow in names)
    phases = count_text(statistics.pauses.count + 1, "phase")
    return (
        f"{flow.publisher} spoke in {phases}, {short_duration(statistics.active)} in all "
        f"({_share(statistics, duration)} of the run), {short_duration(overlapped)} of it in vain "
        f"beside {others}; right only if {flow.publisher} may interrupt"
    )


def _share(figures: FlowStatistics, duration: int) -> str:
    percent = min(100 * figures.active / duration, 100)
    return f"{percent:.0f} %" if percent >= 1 else f"{percent:.1g} %"


def _changed(node: str, flow: Flow, new: int, why: str, figures: FlowStatistics) -> TuningProposal:
    return TuningProposal(
        kind=TuningProposalKind.CHANGE,
        node=node,
        flow=flow.name,
        key="priority",
        before=str(flow.priority),
        after=str(new),
        why=why,
        samples=figures.messages,
    )
