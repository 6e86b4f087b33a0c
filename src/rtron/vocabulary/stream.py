"""A Stream: all that governs one topic, as one pipeline in the order GRCN, MSRCN, RSRCN."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from rtron.vocabulary.enums import CoordinationKind, Mode, PolicyName, StreamKind
from rtron.vocabulary.names import names_node
from rtron.vocabulary.plan import GRCN, SECOND, Flow, GuardedTopic, Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicySettings:
    """What a policy is built from; all durations in ns, `revision` goes into every verdict."""

    policy: PolicyName
    kind: StreamKind
    flows: tuple[Flow, ...]
    release_after: int = SECOND // 2
    max_age: int = SECOND // 2
    max_hold: int = 600 * SECOND
    queue_size: int = 100
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One coordination node's part in a stream; `id` is also the last part of its node name."""

    id: str
    coordination: CoordinationKind
    settings: PolicySettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """One topic's flows, the stages they go through in order, and the successors behind them."""

    topic: str
    type: str
    mode: Mode
    flows: tuple[Flow, ...]
    stages: tuple[Stage, ...]
    successors: tuple[str, ...]
    queue_size: int = 100
    done: str | None = None
    block_unapproved: bool = True


def streams(plan: Plan) -> tuple[Stream, ...]:
    """Return the plan's streams, one a topic and mode, in the order of the plan.

    A stage that observes never shares a stream with one that enforces: it has none of its say.
    """
    found = {(grcn.topic, grcn.mode): _grcn_stream(grcn, plan.revision) for grcn in plan.grcn}
    for stage, mode, guarded in _later_stages(plan):
        key = (guarded.topic, mode)
        found[key] = _append(found.get(key) or _bare_stream(guarded, mode), stage, guarded)
    return tuple(found.values())


def _grcn_stream(grcn: GRCN, revision: int) -> Stream:
    settings = PolicySettings(
        policy=grcn.policy,
        kind=grcn.kind,
        flows=grcn.flows,
        release_after=grcn.release_after,
        max_age=grcn.max_age,
        max_hold=grcn.max_hold,
        queue_size=grcn.queue_size,
        revision=revision,
    )
    return Stream(
        topic=grcn.topic,
        type=grcn.type,
        mode=grcn.mode,
        flows=grcn.flows,
        stages=(Stage(id=grcn.id, coordination=CoordinationKind.GRCN, settings=settings),),
        successors=grcn.successors,
        queue_size=grcn.queue_size,
        done=grcn.done,
        block_unapproved=grcn.block_unapproved,
    )


def _later_stages(plan: Plan) -> Iterator[tuple[Stage, Mode, GuardedTopic]]:
    if plan.msrcn:
        stage = _stage(plan.msrcn.id, CoordinationKind.MSRCN, plan.msrcn.policy, plan.revision)
        yield from ((stage, plan.msrcn.mode, topic) for topic in plan.msrcn.aflows)
    if plan.rsrcn:
        stage = _stage(plan.rsrcn.id, CoordinationKind.RSRCN, plan.rsrcn.policy, plan.revision)
        yield from ((stage, plan.rsrcn.mode, topic) for topic in plan.rsrcn.vflows)


def _stage(id: str, coordination: CoordinationKind, policy: PolicyName, revision: int) -> Stage:
    settings = PolicySettings(policy=policy, kind=StreamKind.COMMAND, flows=(), revision=revision)
    return Stage(id=id, coordination=coordination, settings=settings)


def _bare_stream(guarded: GuardedTopic, mode: Mode) -> Stream:
    return Stream(
        topic=guarded.topic,
        type=guarded.type,
        mode=mode,
        flows=guarded.flows,
        stages=(),
        successors=guarded.successors,
    )


def _append(stream: Stream, stage: Stage, guarded: GuardedTopic) -> Stream:
    """Add a stage.

    Its block bits hold in the stages before it too: a flow that will not pass must not take the
    output from others there.
    """
    blocked = tuple(flow.publisher for flow in guarded.flows if flow.block)
    flows = tuple(replace(flow, block=False) for flow in stream.flows)
    own = replace(stage, settings=replace(stage.settings, flows=flows))
    stages = tuple(_with_blocks(each, blocked) for each in (*stream.stages, own))
    return replace(stream, stages=stages)


def _with_blocks(stage: Stage, blocked: tuple[str, ...]) -> Stage:
    flows = tuple(
        replace(flow, block=flow.block or any(_overlap(flow.publisher, name) for name in blocked))
        for flow in stage.settings.flows
    )
    return replace(stage, settings=replace(stage.settings, flows=flows))


def _overlap(one: str, other: str) -> bool:
    return names_node(one, other) or names_node(other, one)
