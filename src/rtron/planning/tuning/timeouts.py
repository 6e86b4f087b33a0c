"""How long a flow may say nothing: `release_after`, `timeout` of commands, `silent_after`.

All three follow from the gaps within a flow's phases. `release_after` is one for all flows of a
GRCN, so it follows the one that needs longest, but not the flow that comes last: nobody waits for
that. A pause of a flow that left the robot moving speaks against a shorter `silent_after`: the
robot would be stopped where it was not before.
"""

from collections.abc import Sequence
from dataclasses import replace

from rtron.planning.tuning.formatting import count_text
from rtron.planning.tuning.run_statistics import (
    SILENCE_BOUNDS,
    AddProposal,
    PlanKey,
    RunStatistics,
    describe_durations,
    fit_duration,
    flow_statistics,
)
from rtron.vocabulary import (
    GRCN,
    EventFlow,
    EventStatistics,
    Flow,
    FlowStatistics,
    PolicyName,
    StreamKind,
    StreamStatistics,
    normalise_type,
)

_QUEUES = (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE)
_LIMITS = ("std_msgs/Float64", "std_msgs/Float32")


def tune_release_after(grcn: GRCN, stream: StreamStatistics, note: AddProposal) -> GRCN:
    """Return a GRCN whose flows keep the output through the gaps of their phases."""
    awaited = [flow for flow in _awaited_flows(grcn) if _uses_release_after(grcn, flow)]
    if not awaited:
        return grcn
    figures = [flow_statistics(stream, flow) for flow in awaited]
    gaps = [each.gaps for each in figures]
    fit = fit_duration(grcn.release_after, gaps, SILENCE_BOUNDS)
    measured = "; ".join(f"{each.flow}: {describe_durations(each.gaps, 'gap')}" for each in figures)
    plan_key = PlanKey(node=grcn.id, key="release_after")
    least = min(each.count for each in gaps)
    note(plan_key.proposal(grcn.release_after, fit, measured, least))
    return replace(grcn, release_after=fit.after)


def tune_command_timeouts(grcn: GRCN, stream: StreamStatistics, note: AddProposal) -> GRCN:
    """Return a GRCN whose queued commands wait through the gaps of those before them."""
    if grcn.policy not in _QUEUES or grcn.kind is not StreamKind.COMMAND:
        return grcn
    awaited = {flow.name for flow in _awaited_flows(grcn) if flow.timeout is not None}
    flows = (
        _with_timeout(grcn.id, f, stream, note) if f.name in awaited else f for f in grcn.flows
    )
    return replace(grcn, flows=tuple(flows))


def tune_silences(
    node: str, type: str, flows: Sequence[Flow], stream: StreamStatistics, note: AddProposal
) -> tuple[Flow, ...]:
    """Return the flows of a velocity stream, each of which may be silent as it usually is."""
    if normalise_type(type) in _LIMITS:
        return tuple(flows)
    return tuple(_with_silence(node, flow, flow_statistics(stream, flow), note) for flow in flows)


def _with_silence(node: str, flow: Flow, figures: FlowStatistics, note: AddProposal) -> Flow:
    if not figures.speeds.count:
        return flow
    left = count_text(figures.left_moving, "pause") if figures.left_moving else ""
    objection = f"the robot went on through {left}" if left else ""
    fit = fit_duration(flow.silent_after, [figures.gaps], SILENCE_BOUNDS, objection=objection)
    plan_key = PlanKey(node=node, flow=flow.name, key="silent_after")
    measured = describe_durations(figures.gaps, "gap")
    note(plan_key.proposal(flow.silent_after, fit, measured, figures.gaps.count))
    return replace(flow, silent_after=fit.after)


def _with_timeout(node: str, flow: Flow, stream: StreamStatistics, note: AddProposal) -> Flow:
    figures, before = flow_statistics(stream, flow).gaps, flow.timeout or 0
    fit = fit_duration(before, [figures], SILENCE_BOUNDS)
    plan_key = PlanKey(node=node, flow=flow.name, key="timeout")
    note(plan_key.proposal(before, fit, describe_durations(figures, "gap"), figures.count))
    return replace(flow, timeout=fit.after)


def _awaited_flows(grcn: GRCN) -> list[Flow]:
    """Return the flows for whose silence others wait."""
    flows = [flow for flow in grcn.flows if not flow.block]
    if grcn.policy is PolicyName.FIFO_QUEUE:
        return flows if len(flows) > 1 else []
    if not grcn.block_unapproved:
        return flows
    last = min((flow.priority for flow in flows), default=0)
    return [flow for flow in flows if flow.priority > last]


def _uses_release_after(grcn: GRCN, flow: Flow) -> bool:
    if grcn.policy is PolicyName.PREEMPTION:
        return True
    commands = grcn.kind is StreamKind.COMMAND and grcn.policy in _QUEUES
    return commands and flow.timeout is None


def tune_event_ages(
    node: str, flow: EventFlow, measured: RunStatistics, note: AddProposal
) -> EventFlow:
    """Return an eflow whose bit is known through the gaps of its source."""
    named = (each for each in measured.run.events if each.name == flow.name)
    figures = next(named, EventStatistics(name=flow.name))
    if flow.silent is not None:
        why = "an absence is not to be told too early"
        after = _fit_event_duration(node, flow, "silent", figures, note, why)
        return replace(flow, silent=after)
    if flow.when and flow.present is None:
        why = "it comes when something changes" if figures.pauses.count else ""
        return replace(flow, max_age=_fit_event_duration(node, flow, "max_age", figures, note, why))
    return flow


def _fit_event_duration(
    node: str,
    flow: EventFlow,
    key: str,
    figures: EventStatistics,
    note: AddProposal,
    objection: str,
) -> int:
    before: int = getattr(flow, key)
    fit = fit_duration(before, [figures.gaps], SILENCE_BOUNDS, objection=objection)
    plan_key = PlanKey(node=node, flow=flow.name, key=key)
    note(
        plan_key.proposal(before, fit, describe_durations(figures.gaps, "gap"), figures.gaps.count)
    )
    return fit.after
