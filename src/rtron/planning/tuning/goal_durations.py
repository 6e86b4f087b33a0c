"""How long goals take and wait: `timeout`, `max_hold` and `max_age` of a GRCN that queues."""

from collections.abc import Sequence
from dataclasses import replace

from rtron.planning.tuning.duration_fit import GOALS, WAITS, measures, settle
from rtron.planning.tuning.formatting import number, written
from rtron.planning.tuning.run_statistics import Note, Place, of_flow
from rtron.vocabulary import (
    GRCN,
    Decision,
    DurationFigures,
    Flow,
    FlowFigures,
    PolicyName,
    Proposal,
    ProposalKind,
    StreamFigures,
    StreamKind,
    action_of,
)

QUEUES = (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE)


def with_durations(grcn: GRCN, stream: StreamFigures, note: Note) -> GRCN:
    """Return a GRCN whose goals may take as long as they do."""
    if grcn.policy not in QUEUES or grcn.kind is StreamKind.COMMAND:
        return grcn
    heard = [each for flow in grcn.flows if (each := of_flow(stream, flow)).messages]
    if heard and not any(each.takes.count for each in heard):
        note(_unseen(grcn, sum(each.messages for each in heard)))
        return grcn
    undone = _undone(heard)
    flows = (_with_timeout(grcn.id, f, of_flow(stream, f), undone, note) for f in grcn.flows)
    return _with_hold(replace(grcn, flows=tuple(flows)), heard, note)


def with_age(grcn: GRCN, stream: StreamFigures, note: Note) -> GRCN:
    """Return a GRCN in which nothing waits for much longer than it had to.

    Only where none of its durations has become another: they decide how long others wait. What is
    dropped for its age was stale, so `max_age` is never made longer.
    """
    if grcn.policy not in QUEUES:
        return grcn
    figures = [of_flow(stream, flow) for flow in grcn.flows]
    waits = _merged([each.waits for each in figures])
    found = settle(grcn.max_age, [waits], WAITS, objection=_expired(grcn, figures))
    if not waits.count or found.after > grcn.max_age:
        return grcn
    place = Place(node=grcn.id, key="max_age")
    note(place.settled(grcn.max_age, found, measures(waits, "wait"), waits.count))
    return replace(grcn, max_age=found.after)


def _with_timeout(node: str, flow: Flow, figures: FlowFigures, undone: str, note: Note) -> Flow:
    if flow.timeout is None or not figures.messages:
        return flow
    found = settle(flow.timeout, [figures.takes], GOALS, objection=undone)
    place = Place(node=node, flow=flow.name, key="timeout")
    told = measures(figures.takes, "goal")
    note(place.settled(flow.timeout, found, told, figures.takes.count))
    return replace(flow, timeout=found.after)


def _with_hold(grcn: GRCN, heard: Sequence[FlowFigures], note: Note) -> GRCN:
    if not heard:
        return grcn
    takes = _merged([each.takes for each in heard])
    rare = [each.flow for each in heard if each.takes.count < GOALS.enough]
    objection = f"too little is known of {', '.join(rare)}" if rare else _undone(heard)
    found = settle(grcn.max_hold, [takes], GOALS, objection=objection)
    place = Place(node=grcn.id, key="max_hold")
    note(place.settled(grcn.max_hold, found, measures(takes, "goal"), takes.count))
    return replace(grcn, max_hold=found.after)


def _merged(all_of: Sequence[DurationFigures]) -> DurationFigures:
    """Return figures that none of these exceeds: the counts together, the largest quantiles."""
    return DurationFigures(
        count=sum(each.count for each in all_of),
        p50=max((each.p50 for each in all_of), default=0),
        p99=max((each.p99 for each in all_of), default=0),
        p999=max((each.p999 for each in all_of), default=0),
        max=max((each.max for each in all_of), default=0),
    )


def _undone(figures: Sequence[FlowFigures]) -> str:
    undone = sum(each.undone for each in figures)
    return f"nothing told the end of {number(undone, 'goal')}" if undone else ""


def _expired(grcn: GRCN, figures: Sequence[FlowFigures]) -> str:
    """Return whether goals waited that never went; of commands a newer one takes the place."""
    held = sum(
        each.count for one in figures for each in one.refusals if each.decision is Decision.HOLD
    )
    went = sum(each.waits.count for each in figures)
    if grcn.kind is StreamKind.COMMAND or held <= went:
        return ""
    return f"{number(held - went, 'message')} waited and never went"


def _unseen(grcn: GRCN, goals: int) -> Proposal:
    told = f"nothing told the end of {number(goals, 'goal')}"
    how = "`done` is wrong" if grcn.done else "`done` names no topic that tells it"
    if action_of(grcn.topic, grcn.type):
        how = "its server gave no result"
    return Proposal(
        kind=ProposalKind.LOOK,
        node=grcn.id,
        key="done",
        before=grcn.done or "",
        after=grcn.done or "",
        why=f"{told}: {how}; `max_hold` is {written(grcn.max_hold)}",
        samples=goals,
    )
