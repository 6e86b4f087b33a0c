"""From a plan to its streams: the stages of each topic in the order GRCN, MSRCN, RSRCN."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from rtron.vocabulary.action import action_name
from rtron.vocabulary.enums import CoordinationKind, Decision, Mode, PolicyName, StreamKind
from rtron.vocabulary.names import patterns_overlap
from rtron.vocabulary.plan import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    UNAPPROVED,
    Flow,
    GuardedTopic,
    MissionRule,
    Plan,
    StopProfile,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StageRule:
    """A rule of the mission on one topic: the flows it blocks, and those that meet what it asks."""

    name: str
    blocked_flows: frozenset[str] = frozenset()
    required_flows: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicySettings:
    """What a policy is built from; `revision` goes into every verdict.

    Durations are in ns, `threshold` in metres per frame, `max_vel_limit`, `max_side_limit` and
    `lowest` in m/s, `max_turn_limit` in rad/s, `max_accel_limit` in m/s2.
    """

    policy: PolicyName
    kind: StreamKind
    flows: tuple[Flow, ...]
    release_after: int = SECOND // 2
    max_age: int = SECOND // 2
    max_hold: int = 600 * SECOND
    queue_size: int = 100
    threshold: float | None = None
    max_vel_limit: float | None = None
    max_turn_limit: float | None = None
    max_side_limit: float | None = None
    max_accel_limit: float | None = None
    lowest: float = 0.0
    rules: tuple[StageRule, ...] = ()
    lease: str = ""
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One coordination node's part in a stream; `id` is also the last part of its node name."""

    id: str
    coordination_kind: CoordinationKind
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
    uses: tuple[str, ...] = ()
    stop: StopProfile = StopProfile()  # noqa: RUF009 - frozen

    @property
    def action(self) -> str:
        """The action whose goals these are, all of which moves together; or nothing."""
        return action_name(self.topic, self.type)

    @property
    def is_command(self) -> bool:
        """Whether each of its messages moves the robot by itself."""
        return self.stages[0].settings.kind is StreamKind.COMMAND and not self.action

    @property
    def is_ros2_action(self) -> bool:
        """Whether these are an action's goals in ROS 2, which are requests and no topic."""
        return self.action == self.topic


@dataclass(frozen=True, slots=True)
class _StageOnTopic:
    """What the MSRCN or the RSRCN has to do with one topic."""

    stage: Stage
    mode: Mode
    topic: GuardedTopic
    rules: tuple[MissionRule, ...] = ()


def build_streams(plan: Plan) -> tuple[Stream, ...]:
    """Return the plan's streams, one a topic and mode, in the order of the plan.

    A stage that observes never shares a stream with one that enforces: it has none of its say.
    """
    by_topic = {(grcn.topic, grcn.mode): _grcn_stream(grcn, plan.revision) for grcn in plan.grcn}
    for part in (*_msrcn_parts(plan), *_rsrcn_parts(plan)):
        key = (part.topic.topic, part.mode)
        by_topic[key] = _append(by_topic.get(key) or _empty_stream(part.topic, part.mode), part)
    return tuple(replace(stream, stop=plan.stop) for stream in by_topic.values())


def _grcn_stream(grcn: GRCN, revision: int) -> Stream:
    settings = PolicySettings(
        policy=grcn.policy,
        kind=grcn.kind,
        flows=grcn.flows,
        release_after=grcn.release_after,
        max_age=grcn.max_age,
        max_hold=grcn.max_hold,
        queue_size=grcn.queue_size,
        lease=grcn.lease,
        revision=revision,
    )
    return Stream(
        topic=grcn.topic,
        type=grcn.type,
        mode=grcn.mode,
        flows=grcn.flows,
        stages=(Stage(id=grcn.id, coordination_kind=CoordinationKind.GRCN, settings=settings),),
        successors=grcn.successors,
        queue_size=grcn.queue_size,
        done=grcn.done,
        block_unapproved=grcn.block_unapproved,
        uses=grcn.uses,
    )


def _msrcn_parts(plan: Plan) -> Iterator[_StageOnTopic]:
    if plan.msrcn:
        stage = _stage(plan.msrcn, CoordinationKind.MSRCN, plan.revision)
        for topic in plan.msrcn.aflows:
            yield _StageOnTopic(stage, plan.msrcn.mode, topic, plan.msrcn.rules)


def _rsrcn_parts(plan: Plan) -> Iterator[_StageOnTopic]:
    if plan.rsrcn:
        stage = _with_limits(_stage(plan.rsrcn, CoordinationKind.RSRCN, plan.revision), plan.rsrcn)
        yield from (_StageOnTopic(stage, plan.rsrcn.mode, topic) for topic in plan.rsrcn.vflows)


def _stage(node: MSRCN | RSRCN, coordination: CoordinationKind, revision: int) -> Stage:
    settings = PolicySettings(
        policy=node.policy, kind=StreamKind.COMMAND, flows=(), revision=revision
    )
    return Stage(id=node.id, coordination_kind=coordination, settings=settings)


def _with_limits(stage: Stage, rsrcn: RSRCN) -> Stage:
    settings = replace(
        stage.settings,
        threshold=rsrcn.threshold,
        max_vel_limit=rsrcn.max_vel_limit,
        max_turn_limit=rsrcn.max_turn_limit,
        max_side_limit=rsrcn.max_side_limit,
        max_accel_limit=rsrcn.max_accel_limit,
        lowest=rsrcn.lowest,
    )
    return replace(stage, settings=settings)


def _empty_stream(guarded: GuardedTopic, mode: Mode) -> Stream:
    return Stream(
        topic=guarded.topic,
        type=guarded.type,
        mode=mode,
        flows=guarded.flows,
        stages=(),
        successors=guarded.successors,
        uses=guarded.uses,
    )


def _append(stream: Stream, part: _StageOnTopic) -> Stream:
    """Add a stage.

    Its block bits hold in the stages before it too: a flow that will not pass must not take the
    output from others there.
    """
    flows = part.topic.flows
    settings = replace(
        part.stage.settings,
        flows=tuple(_with_stage_priorities(stream.flows, flows)),
        rules=tuple(_stage_rules(part.rules, stream, flows)),
    )
    blocked = [flow.publisher for flow in flows if flow.block]
    stages = (*stream.stages, replace(part.stage, settings=settings))
    if not blocked:
        return replace(stream, stages=stages)
    index = _PublisherIndex(blocked)
    return replace(stream, stages=tuple(_with_blocks(each, index) for each in stages))


class _PublisherIndex:
    """Publishers of flows: a name is looked up, only patterns are compared one by one."""

    def __init__(self, publishers: Iterable[str]) -> None:
        self._publishers = frozenset(publishers)
        self._patterns = tuple(filter(_is_pattern, self._publishers))

    def overlapping(self, publisher: str) -> list[str]:
        """Return those that mean a publisher, or that it means."""
        candidates = self._publishers
        if not _is_pattern(publisher):
            candidates = candidates.intersection([publisher]).union(self._patterns)
        return [each for each in candidates if patterns_overlap(publisher, each)]


def _is_pattern(publisher: str) -> bool:
    return any(character in publisher for character in "*?[")


def _with_stage_priorities(flows: Iterable[Flow], guarded: Iterable[Flow]) -> Iterator[Flow]:
    """Yield the stream's flows with the priorities that the stage gives them."""
    highest: dict[str, int] = {}
    for flow in guarded:
        highest[flow.publisher] = max(flow.priority, highest.get(flow.publisher, flow.priority))
    index = _PublisherIndex(highest)
    for flow in flows:
        priority = max((highest[each] for each in index.overlapping(flow.publisher)), default=0)
        is_same = priority == flow.priority and not flow.block
        yield flow if is_same else replace(flow, block=False, priority=priority)


def _stage_rules(
    rules: Sequence[MissionRule], stream: Stream, guarded: Sequence[Flow]
) -> Iterator[StageRule]:
    names = {stream.topic, *(flow.name for flow in guarded)}
    for rule in rules:
        if rule.require in names or not names.isdisjoint(rule.block):
            yield _stage_rule(rule, stream, guarded)
        else:
            yield _unrelated_rule(rule.name)


@lru_cache(1000)
def _unrelated_rule(name: str) -> StageRule:
    """Return a rule that is not about the stream; all streams share it."""
    return StageRule(name=name)


def _stage_rule(rule: MissionRule, stream: Stream, guarded: Sequence[Flow]) -> StageRule:
    """Return a rule of the mission, with the names that its flows have in the stream."""
    return StageRule(
        name=rule.name,
        blocked_flows=_matching_flows(rule.block, stream, guarded),
        required_flows=_matching_flows((rule.require,), stream, guarded),
    )


def _matching_flows(
    names: Sequence[str], stream: Stream, guarded: Sequence[Flow]
) -> frozenset[str]:
    """Return the flows of a stream that are meant by their names, or all by their topic's."""
    if stream.topic in names:
        return frozenset(flow.name for flow in stream.flows) | {UNAPPROVED}
    named = frozenset(names)
    index = _PublisherIndex(flow.publisher for flow in guarded if flow.name in named)
    return frozenset(flow.name for flow in stream.flows if index.overlapping(flow.publisher))


def _with_blocks(stage: Stage, blocked: _PublisherIndex) -> Stage:
    flows = tuple(
        replace(flow, block=flow.block or bool(blocked.overlapping(flow.publisher)))
        for flow in stage.settings.flows
    )
    return replace(stage, settings=replace(stage.settings, flows=flows))


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer to one message of one flow, with the policy, reason and settings revision.

    `message` is what goes on in its place (modify). `error`: the message could not be judged.
    """

    decision: Decision
    flow: str
    policy: PolicyName
    reason: str
    revision: int
    message: object = None
    error: bool = False
