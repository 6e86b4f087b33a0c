"""How long a flow may say nothing: `release_after`, `timeout` of commands, `silent_after`.

All three follow from the gaps within a flow's phases. `release_after` is one for all flows of a
GRCN, so it follows the one that needs longest, but not the flow that comes last: nobody waits for
that. A pause of a flow that left the robot moving speaks against a shorter `silent_after`: the
robot would be stopped where it was not before.
"""

from collections.abc import Sequence
from dataclasses import replace

from rtron.planning.tuning.duration_fit import SILENCE, measures, settle
from rtron.planning.tuning.formatting import number
from rtron.planning.tuning.run_statistics import Note, Place, of_flow
from rtron.vocabulary import (
    GRCN,
    Flow,
    FlowFigures,
    PolicyName,
    StreamFigures,
    StreamKind,
    normalise_type,
)

_QUEUES = (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE)
_LIMITS = ("std_msgs/Float64", "std_msgs/Float32")


def with_release(grcn: GRCN, stream: StreamFigures, note: Note) -> GRCN:
    """Return a GRCN whose flows keep the output through the gaps of their phases."""
    waited = [flow for flow in _waited_for(grcn) if _by_release(grcn, flow)]
    if not waited:
        return grcn
    figures = [of_flow(stream, flow) for flow in waited]
    gaps = [each.gaps for each in figures]
    found = settle(grcn.release_after, gaps, SILENCE)
    told = "; ".join(f"{each.flow}: {measures(each.gaps, 'gap')}" for each in figures)
    place = Place(node=grcn.id, key="release_after")
    least = min(each.count for each in gaps)
    note(place.settled(grcn.release_after, found, told, least))
    return replace(grcn, release_after=found.after)


def with_timeouts(grcn: GRCN, stream: StreamFigures, note: Note) -> GRCN:
    """Return a GRCN whose queued commands wait through the gaps of those before them."""
    if grcn.policy not in _QUEUES or grcn.kind is not StreamKind.COMMAND:
        return grcn
    waited = {flow.name for flow in _waited_for(grcn) if flow.timeout is not None}
    flows = (_with_timeout(grcn.id, f, stream, note) if f.name in waited else f for f in grcn.flows)
    return replace(grcn, flows=tuple(flows))


def with_silences(
    node: str, type: str, flows: Sequence[Flow], stream: StreamFigures, note: Note
) -> tuple[Flow, ...]:
    """Return the flows of a velocity stream, each of which may be silent as it usually is."""
    if normalise_type(type) in _LIMITS:
        return tuple(flows)
    return tuple(_with_silence(node, flow, of_flow(stream, flow), note) for flow in flows)


def _with_silence(node: str, flow: Flow, figures: FlowFigures, note: Note) -> Flow:
    if not figures.speeds.count:
        return flow
    left = number(figures.left_moving, "pause") if figures.left_moving else ""
    objection = f"the robot went on through {left}" if left else ""
    found = settle(flow.silent_after, [figures.gaps], SILENCE, objection=objection)
    place = Place(node=node, flow=flow.name, key="silent_after")
    told = measures(figures.gaps, "gap")
    note(place.settled(flow.silent_after, found, told, figures.gaps.count))
    return replace(flow, silent_after=found.after)


def _with_timeout(node: str, flow: Flow, stream: StreamFigures, note: Note) -> Flow:
    figures, before = of_flow(stream, flow).gaps, flow.timeout or 0
    found = settle(before, [figures], SILENCE)
    place = Place(node=node, flow=flow.name, key="timeout")
    note(place.settled(before, found, measures(figures, "gap"), figures.count))
    return replace(flow, timeout=found.after)


def _waited_for(grcn: GRCN) -> list[Flow]:
    """Return the flows for whose silence others wait."""
    flows = [flow for flow in grcn.flows if not flow.block]
    if grcn.policy is PolicyName.FIFO_QUEUE:
        return flows if len(flows) > 1 else []
    if not grcn.block_unapproved:
        return flows
    last = min((flow.priority for flow in flows), default=0)
    return [flow for flow in flows if flow.priority > last]


def _by_release(grcn: GRCN, flow: Flow) -> bool:
    if grcn.policy is PolicyName.PREEMPTION:
        return True
    commands = grcn.kind is StreamKind.COMMAND and grcn.policy in _QUEUES
    return commands and flow.timeout is None
