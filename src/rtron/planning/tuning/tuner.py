"""A plan and a measured run give a plan that fits the run, and what changed for which figures.

The figures are those of a run in which nothing was amiss: what happened in it counts as normal.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from textwrap import wrap

from rtron.coherence.shared_topics import shared_topic_problems
from rtron.planning.plan_file.writer import write_plan
from rtron.planning.tuning.flow_priorities import tune_priorities
from rtron.planning.tuning.formatting import count_text
from rtron.planning.tuning.goal_durations import tune_goal_durations, tune_max_age
from rtron.planning.tuning.run_statistics import AddProposal, RunStatistics, flow_statistics
from rtron.planning.tuning.timeouts import (
    tune_command_timeouts,
    tune_event_ages,
    tune_release_after,
    tune_silences,
)
from rtron.planning.tuning.velocity_limits import (
    report_limited_velocities,
    tune_frame_monitor,
    tune_threshold,
)
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    Flow,
    GuardedTopic,
    MeasuredRun,
    Mode,
    Plan,
    StreamKind,
    StreamStatistics,
    TuningProposal,
    TuningProposalKind,
)


def observations(
    node: str, flows: Sequence[Flow], stream: StreamStatistics
) -> Iterator[TuningProposal]:
    """Yield what there is to look at on one topic."""
    for flow in flows:
        if not flow_statistics(stream, flow).messages:
            why = f"{flow.publisher} never spoke: nothing can be said about it"
            yield _look_proposal(node, "publisher", why, 0, flow.name)
    for name in stream.strangers:
        why = f"{name} is not in the plan and published here: give it a flow, or leave it blocked"
        message_count = sum(each.messages for each in stream.flows if each.flow == UNAPPROVED)
        total = (
            f" ({count_text(message_count, 'message')} of strangers in all)"
            if message_count
            else ""
        )
        yield _look_proposal(node, "flows", why + total, message_count)


def _look_proposal(node: str, key: str, why: str, samples: int, flow: str = "") -> TuningProposal:
    return TuningProposal(
        kind=TuningProposalKind.LOOK, node=node, flow=flow, key=key, why=why, samples=samples
    )


_DEFAULT = Flow(name="", publisher="")


def tune_plan(plan: Plan, run: MeasuredRun) -> tuple[Plan, tuple[TuningProposal, ...]]:
    """Return the plan with what the run proposes, and a proposal for each value looked at."""
    proposals: list[TuningProposal] = []
    statistics, add = RunStatistics.from_run(run), proposals.append
    if (run.app, run.ros) != (plan.app, plan.ros):
        add(_other_app(plan, run))
    first = {(grcn.topic, grcn.mode) for grcn in plan.grcn}
    msrcn = plan.msrcn and _msrcn(plan.msrcn, statistics, add, first)
    if msrcn:
        first |= {(topic.topic, msrcn.mode) for topic in msrcn.aflows}
    tuned = replace(
        plan,
        grcn=tuple(_grcn(grcn, statistics, add) for grcn in plan.grcn),
        msrcn=msrcn,
        rsrcn=plan.rsrcn and _rsrcn(plan.rsrcn, statistics, add, first),
        fps_monitor=tuple(tune_frame_monitor(each, statistics, add) for each in plan.fps_monitor),
    )
    return _without_ignored_silences(tuned), tuple(proposals)


def _without_ignored_silences(plan: Plan) -> Plan:
    """Return the plan without what a later node says of a silence that the first now decides."""
    lost = {id(part) for part, key, _ in shared_topic_problems(plan) if key == "silent_after"}

    def with_own_flows(topics: tuple[GuardedTopic, ...]) -> tuple[GuardedTopic, ...]:
        return tuple(replace(topic, flows=tuple(map(own, topic.flows))) for topic in topics)

    def own(flow: Flow) -> Flow:
        return replace(flow, silent_after=_DEFAULT.silent_after) if id(flow) in lost else flow

    if not lost:
        return plan
    return replace(
        plan,
        msrcn=plan.msrcn and replace(plan.msrcn, aflows=with_own_flows(plan.msrcn.aflows)),
        rsrcn=plan.rsrcn and replace(plan.rsrcn, vflows=with_own_flows(plan.rsrcn.vflows)),
    )


def _grcn(grcn: GRCN, measured: RunStatistics, note: AddProposal) -> GRCN:
    stream = measured.stream(grcn.topic, grcn.mode)
    if stream is None:
        note(_no_statistics(grcn.id, grcn.topic))
        return grcn
    tuned = tune_priorities(grcn, stream, measured.run.duration, note)
    tuned = tune_release_after(tuned, stream, note)
    tuned = tune_command_timeouts(tuned, stream, note)
    tuned = tune_goal_durations(tuned, stream, note)
    if tuned == grcn:
        tuned = tune_max_age(tuned, stream, note)
    if grcn.mode is Mode.ENFORCE:
        if grcn.kind is StreamKind.COMMAND:
            flows = tune_silences(grcn.id, grcn.type, tuned.flows, stream, note)
            tuned = replace(tuned, flows=flows)
        for remark in observations(grcn.id, grcn.flows, stream):
            note(remark)
    return tuned


def _msrcn(
    msrcn: MSRCN, measured: RunStatistics, note: AddProposal, first: set[tuple[str, Mode]]
) -> MSRCN:
    aflows = tuple(_topic(msrcn, topic, measured, note, first) for topic in msrcn.aflows)
    eflows = tuple(tune_event_ages(msrcn.id, flow, measured, note) for flow in msrcn.eflows)
    return replace(msrcn, aflows=aflows, eflows=eflows)


def _rsrcn(
    rsrcn: RSRCN, measured: RunStatistics, note: AddProposal, first: set[tuple[str, Mode]]
) -> RSRCN:
    report_limited_velocities(rsrcn, measured, note)
    vflows = tuple(_topic(rsrcn, topic, measured, note, first) for topic in rsrcn.vflows)
    return replace(tune_threshold(rsrcn, measured, note), vflows=vflows)


def _topic(
    node: MSRCN | RSRCN,
    topic: GuardedTopic,
    measured: RunStatistics,
    note: AddProposal,
    first: set[tuple[str, Mode]],
) -> GuardedTopic:
    """Return a topic with what its flows need, if this node is the first before it."""
    if (topic.topic, node.mode) in first:
        return topic
    stream = measured.stream(topic.topic, node.mode)
    if stream is None:
        note(_no_statistics(node.id, topic.topic))
        return topic
    if node.mode is not Mode.ENFORCE:
        return topic
    for remark in observations(node.id, topic.flows, stream):
        note(remark)
    return replace(topic, flows=tune_silences(node.id, topic.type, topic.flows, stream, note))


def _no_statistics(node: str, topic: str) -> TuningProposal:
    why = f"the run has no figures of {topic}: it was measured under another plan"
    return TuningProposal(kind=TuningProposalKind.LOOK, node=node, key="topic", why=why)


def _other_app(plan: Plan, run: MeasuredRun) -> TuningProposal:
    why = f"the run is of {run.app!r} on ROS {run.ros}, the plan for {plan.app!r} on ROS {plan.ros}"
    return TuningProposal(kind=TuningProposalKind.LOOK, node=plan.app, key="app", why=why)


_WIDTH = 98
_ID = re.compile(r"( *)(?:- )?id: \"?(\w+)\"?")


def tuned_yaml(plan: Plan, proposals: Sequence[TuningProposal]) -> str:
    """Return the YAML of a plan; above a coordination node stands what a run has changed in it."""
    changed = [each for each in proposals if each.kind is TuningProposalKind.CHANGE]
    return "\n".join(_lines(write_plan(plan).split("\n"), changed))


def _lines(plan: Sequence[str], changed: Sequence[TuningProposal]) -> Iterator[str]:
    for line in plan:
        named = _ID.fullmatch(line)
        for each in changed if named else ():
            if named and each.node == named[2]:
                yield from _comment(each, named[1])
        yield line


def _comment(proposal: TuningProposal, indent: str) -> Iterator[str]:
    where = " ".join(filter(None, (proposal.flow, proposal.key)))
    text = f"{where}: {proposal.before} -> {proposal.after} ({proposal.why})"
    printable = "".join(each if each.isprintable() else "?" for each in text)
    start = f"{indent}# "
    yield from wrap(printable, _WIDTH, initial_indent=start, subsequent_indent=f"{start}  ")
