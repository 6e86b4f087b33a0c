"""How long goals take and wait: `timeout`, `max_hold` and `max_age` of a GRCN that queues."""

from collections.abc import Sequence
from dataclasses import replace

from rtron.planning.tuning.formatting import count_text, plan_duration
from rtron.planning.tuning.run_statistics import (
    GOAL_BOUNDS,
    WAIT_BOUNDS,
    AddProposal,
    PlanKey,
    describe_durations,
    fit_duration,
    flow_statistics,
)
from rtron.vocabulary import (
    GRCN,
    Decision,
    DurationStatistics,
    Flow,
    FlowStatistics,
    PolicyName,
    StreamKind,
    StreamStatistics,
    TuningProposal,
    TuningProposalKind,
    action_name,
)

QUEUE_POLICIES = (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE)


def tune_goal_durations(grcn: GRCN, stream: StreamStatistics, note: AddProposal) -> GRCN:
    """Return a GRCN whose goals may take as long as they do."""
    if grcn.policy not in QUEUE_POLICIES or grcn.kind is StreamKind.COMMAND:
        return grcn
    active = [each for flow in grcn.flows if (each := flow_statistics(stream, flow)).messages]
    if active and not any(each.takes.count for each in active):
        note(_no_end_proposal(grcn, sum(each.messages for each in active)))
        return grcn
    unfinished = _unfinished_text(active)
    flows = (
        _with_timeout(grcn.id, f, flow_statistics(stream, f), unfinished, note) for f in grcn.flows
    )
    return _with_hold(replace(grcn, flows=tuple(flows)), active, note)


def tune_max_age(grcn: GRCN, stream: StreamStatistics, note: AddProposal) -> GRCN:
    """Return a GRCN in which nothing waits for much longer than it had to.

    Only where none of its durations has become another: they decide how long others wait. What is
    dropped for its age was stale, so `max_age` is never made longer.
    """
    if grcn.policy not in QUEUE_POLICIES:
        return grcn
    figures = [flow_statistics(stream, flow) for flow in grcn.flows]
    waits = _merged([each.waits for each in figures])
    fit = fit_duration(
        grcn.max_age, [waits], WAIT_BOUNDS, objection=_unreleased_text(grcn, figures)
    )
    if not waits.count or fit.after > grcn.max_age:
        return grcn
    plan_key = PlanKey(node=grcn.id, key="max_age")
    note(plan_key.proposal(grcn.max_age, fit, describe_durations(waits, "wait"), waits.count))
    return replace(grcn, max_age=fit.after)


def _with_timeout(
    node: str, flow: Flow, figures: FlowStatistics, objection: str, note: AddProposal
) -> Flow:
    if flow.timeout is None or not figures.messages:
        return flow
    fit = fit_duration(flow.timeout, [figures.takes], GOAL_BOUNDS, objection=objection)
    plan_key = PlanKey(node=node, flow=flow.name, key="timeout")
    measured = describe_durations(figures.takes, "goal")
    note(plan_key.proposal(flow.timeout, fit, measured, figures.takes.count))
    return replace(flow, timeout=fit.after)


def _with_hold(grcn: GRCN, active: Sequence[FlowStatistics], note: AddProposal) -> GRCN:
    if not active:
        return grcn
    takes = _merged([each.takes for each in active])
    rare = [each.flow for each in active if each.takes.count < GOAL_BOUNDS.enough_samples]
    objection = f"too little is known of {', '.join(rare)}" if rare else _unfinished_text(active)
    fit = fit_duration(grcn.max_hold, [takes], GOAL_BOUNDS, objection=objection)
    plan_key = PlanKey(node=grcn.id, key="max_hold")
    note(plan_key.proposal(grcn.max_hold, fit, describe_durations(takes, "goal"), takes.count))
    return replace(grcn, max_hold=fit.after)


def _merged(all_of: Sequence[DurationStatistics]) -> DurationStatistics:
    """Return figures that none of these exceeds: the counts together, the largest quantiles."""
    return DurationStatistics(
        count=sum(each.count for each in all_of),
        p50=max((each.p50 for each in all_of), default=0),
        p99=max((each.p99 for each in all_of), default=0),
        p999=max((each.p999 for each in all_of), default=0),
        max=max((each.max for each in all_of), default=0),
    )


def _unfinished_text(figures: Sequence[FlowStatistics]) -> str:
    unfinished = sum(each.undone for each in figures)
    return f"nothing told the end of {count_text(unfinished, 'goal')}" if unfinished else ""


def _unreleased_text(grcn: GRCN, figures: Sequence[FlowStatistics]) -> str:
    """Return whether goals waited that never went; of commands a newer one takes the place."""
    held = sum(
        each.count for one in figures for each in one.refusals if each.decision is Decision.HOLD
    )
    went = sum(each.waits.count for each in figures)
    if grcn.kind is StreamKind.COMMAND or held <= went:
        return ""
    return f"{count_text(held - went, 'message')} waited and never went"


def _no_end_proposal(grcn: GRCN, goals: int) -> TuningProposal:
    observation = f"nothing told the end of {count_text(goals, 'goal')}"
    how = "`done` is wrong" if grcn.done else "`done` names no topic that tells it"
    if action_name(grcn.topic, grcn.type):
        how = "its server gave no result"
    return TuningProposal(
        kind=TuningProposalKind.LOOK,
        node=grcn.id,
        key="done",
        before=grcn.done or "",
        after=grcn.done or "",
        why=f"{observation}: {how}; `max_hold` is {plan_duration(grcn.max_hold)}",
        samples=goals,
    )
