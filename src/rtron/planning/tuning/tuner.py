"""A plan and a measured run give a plan that fits the run, and what changed for which figures.

The figures are those of a run in which nothing was amiss: what happened in it counts as normal.
"""

from dataclasses import replace

from rtron.planning.coherence.shared_topics import shared_misfits
from rtron.planning.tuning.events import with_ages
from rtron.planning.tuning.flow_priorities import with_order
from rtron.planning.tuning.goal_durations import with_age, with_durations
from rtron.planning.tuning.remarks import remarks
from rtron.planning.tuning.run_statistics import Measured, Note
from rtron.planning.tuning.timeouts import with_release, with_silences, with_timeouts
from rtron.planning.tuning.velocity_limits import look_at_limit, with_frames, with_threshold
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    Flow,
    GuardedTopic,
    Mode,
    Plan,
    Proposal,
    ProposalKind,
    Run,
    StreamKind,
)

_DEFAULT = Flow(name="", publisher="")


def tune(plan: Plan, run: Run) -> tuple[Plan, tuple[Proposal, ...]]:
    """Return the plan with what the run proposes, and a proposal for each value looked at."""
    found: list[Proposal] = []
    measured, note = Measured.of(run), found.append
    if (run.app, run.ros) != (plan.app, plan.ros):
        note(_other_app(plan, run))
    first = {(grcn.topic, grcn.mode) for grcn in plan.grcn}
    msrcn = plan.msrcn and _msrcn(plan.msrcn, measured, note, first)
    if msrcn:
        first |= {(topic.topic, msrcn.mode) for topic in msrcn.aflows}
    tuned = replace(
        plan,
        grcn=tuple(_grcn(grcn, measured, note) for grcn in plan.grcn),
        msrcn=msrcn,
        rsrcn=plan.rsrcn and _rsrcn(plan.rsrcn, measured, note, first),
        fps_monitor=tuple(with_frames(each, measured, note) for each in plan.fps_monitor),
    )
    return _without_lost(tuned), tuple(found)


def _without_lost(plan: Plan) -> Plan:
    """Return the plan without what a later node says of a silence that the first now decides."""
    lost = {id(noun) for noun, key, _ in shared_misfits(plan) if key == "silent_after"}

    def kept(topics: tuple[GuardedTopic, ...]) -> tuple[GuardedTopic, ...]:
        return tuple(replace(topic, flows=tuple(map(own, topic.flows))) for topic in topics)

    def own(flow: Flow) -> Flow:
        return replace(flow, silent_after=_DEFAULT.silent_after) if id(flow) in lost else flow

    if not lost:
        return plan
    return replace(
        plan,
        msrcn=plan.msrcn and replace(plan.msrcn, aflows=kept(plan.msrcn.aflows)),
        rsrcn=plan.rsrcn and replace(plan.rsrcn, vflows=kept(plan.rsrcn.vflows)),
    )


def _grcn(grcn: GRCN, measured: Measured, note: Note) -> GRCN:
    stream = measured.stream(grcn.topic, grcn.mode)
    if stream is None:
        note(_nothing(grcn.id, grcn.topic))
        return grcn
    tuned = with_order(grcn, stream, measured.run.duration, note)
    tuned = with_release(tuned, stream, note)
    tuned = with_timeouts(tuned, stream, note)
    tuned = with_durations(tuned, stream, note)
    if tuned == grcn:
        tuned = with_age(tuned, stream, note)
    if grcn.mode is Mode.ENFORCE:
        if grcn.kind is StreamKind.COMMAND:
            flows = with_silences(grcn.id, grcn.type, tuned.flows, stream, note)
            tuned = replace(tuned, flows=flows)
        for remark in remarks(grcn.id, grcn.flows, stream):
            note(remark)
    return tuned


def _msrcn(msrcn: MSRCN, measured: Measured, note: Note, first: set[tuple[str, Mode]]) -> MSRCN:
    aflows = tuple(_topic(msrcn, topic, measured, note, first) for topic in msrcn.aflows)
    eflows = tuple(with_ages(msrcn.id, flow, measured, note) for flow in msrcn.eflows)
    return replace(msrcn, aflows=aflows, eflows=eflows)


def _rsrcn(rsrcn: RSRCN, measured: Measured, note: Note, first: set[tuple[str, Mode]]) -> RSRCN:
    look_at_limit(rsrcn, measured, note)
    vflows = tuple(_topic(rsrcn, topic, measured, note, first) for topic in rsrcn.vflows)
    return replace(with_threshold(rsrcn, measured, note), vflows=vflows)


def _topic(
    node: MSRCN | RSRCN,
    topic: GuardedTopic,
    measured: Measured,
    note: Note,
    first: set[tuple[str, Mode]],
) -> GuardedTopic:
    """Return a topic with what its flows need, if this node is the first before it."""
    if (topic.topic, node.mode) in first:
        return topic
    stream = measured.stream(topic.topic, node.mode)
    if stream is None:
        note(_nothing(node.id, topic.topic))
        return topic
    if node.mode is not Mode.ENFORCE:
        return topic
    for remark in remarks(node.id, topic.flows, stream):
        note(remark)
    return replace(topic, flows=with_silences(node.id, topic.type, topic.flows, stream, note))


def _nothing(node: str, topic: str) -> Proposal:
    why = f"the run has no figures of {topic}: it was measured under another plan"
    return Proposal(kind=ProposalKind.LOOK, node=node, key="topic", why=why)


def _other_app(plan: Plan, run: Run) -> Proposal:
    why = f"the run is of {run.app!r} on ROS {run.ros}, the plan for {plan.app!r} on ROS {plan.ros}"
    return Proposal(kind=ProposalKind.LOOK, node=plan.app, key="app", why=why)
