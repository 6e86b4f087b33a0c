"""The app's events and frame rates that the plan's policies depend on."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from rtron.errors import PlanError
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.encoding import Encoding
from rtron.messages.expressions.condition import Condition
from rtron.messages.expressions.evaluator import MessageEvaluator
from rtron.policies.authority.command_lease import Commander, CommandLease
from rtron.policies.mission.event_bits import EventBit, EventBits
from rtron.policies.mission.rule_block import RuleResult
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.policies.velocity_limit.frame_monitors import FrameMonitors
from rtron.vocabulary import (
    MSRCN,
    EventFlow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    Stream,
    build_streams,
    flow_topic,
    matches_node,
    normalise_type,
)

EvaluateMessage = Callable[[bytes], Sequence[RuleResult]]
"""Evaluates several expressions on a message; returns their results in the same order."""


class EvaluatorFactory:
    """Compiles a plan's expressions, with the areas and transforms of its MSRCN."""

    def __init__(self, plan: Plan, msrcn: MSRCN) -> None:
        self._definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
        self._encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._msrcn = msrcn

    def create(
        self, type: str, subject: str, texts: Sequence[str], frames: Sequence[str]
    ) -> tuple[str, EvaluateMessage]:
        """Return the MD5 sum of `type`, and a function that evaluates `texts` on its messages.

        PlanError if the type is not known or an expression cannot be used.
        """
        definition = self._definitions.find(type)
        if definition is None:
            help = "add its text under `messages`; for ROS 2, source the workspace that has it"
            raise PlanError(f"no definition of {type or 'a type that is not named'}", help=help)
        evaluator = MessageEvaluator(
            definition,
            texts,
            subject=subject,
            encoding=self._encoding,
            areas=self._msrcn.areas,
            transforms=self._msrcn.transforms,
            frames=frames,
        )
        return definition.md5sum, evaluator.evaluate


MAX_EVENT = 1 << 20
"""The longest event that expressions read, bytes: all other streams wait meanwhile."""


@dataclass(frozen=True, slots=True, eq=False)
class EventSource:
    """A publisher's topic and the bits that its messages set; `md5sum` is "" for any type."""

    topic: str
    publisher: str
    type: str
    md5sum: str
    bits: tuple[EventBit, ...]
    evaluate: EvaluateMessage

    def judgements_of(self, message: bytes) -> Sequence[RuleResult]:
        """Return the value of each bit after a message, or why it is unknown."""
        if len(message) > MAX_EVENT and self.md5sum:
            return (f"a message of {len(message)} bytes is too long to read",) * len(self.bits)
        return self.evaluate(message)


@dataclass(frozen=True, slots=True, eq=False)
class ActionEvaluator:
    """Evaluates the `action` expressions of rules on the messages of a topic."""

    md5sum: str
    rules: tuple[str, ...]
    evaluate: EvaluateMessage

    def judgements_of(self, message: object) -> Mapping[str, RuleResult]:
        """Return the result of each rule's `action` for a message."""
        return dict(zip(self.rules, self.evaluate(message), strict=True))  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True)
class PublisherTopics:
    """The topics of a publisher: an approved one of an enforced topic uses a private topic."""

    private_topics: Mapping[tuple[str, str], str] = field(default_factory=dict)

    def topics_of(self, topic: str, publisher: str) -> Iterable[str]:
        """Yield the topics on which a publisher of `topic` may publish."""
        yield topic
        for (guarded_topic, approved), private in self.private_topics.items():
            if guarded_topic == topic and (
                matches_node(approved, publisher) or matches_node(publisher, approved)
            ):
                yield private


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """The state that the policies of all streams share, and its sources."""

    rates: FrameMonitors = field(default_factory=FrameMonitors)
    mission: MissionMonitor = field(default_factory=lambda: MissionMonitor(EventBits()))
    monitors: tuple[FpsMonitor, ...] = ()
    events: tuple[EventSource, ...] = ()
    actions: Mapping[str, ActionEvaluator] = field(default_factory=dict)
    leases: Mapping[str, CommandLease] = field(default_factory=dict)
    node: str = "msrcn"
    publisher_topics: PublisherTopics = field(default_factory=PublisherTopics)

    def update_time(self, now: int) -> None:
        """Apply changes that come by time alone, as of `now` (ns)."""
        self.mission.update_if_due(now)

    def deadline(self, now: int) -> int | None:
        """Return when (ns) the state next changes if no message arrives, None if it does not."""
        times = (self.mission.due, self.rates.deadline(now))
        return min((time for time in times if time is not None), default=None)


def observations_of(plan: Plan) -> Observations:
    """Return what a plan's RSRCN and MSRCN need; PlanError if an expression cannot be used."""
    rates, topics = FrameMonitors(plan.fps_monitor), _publisher_topics(build_streams(plan))
    msrcn, leases = plan.msrcn, _command_leases(plan)
    if msrcn is None:
        return Observations(
            rates=rates, monitors=plan.fps_monitor, leases=leases, publisher_topics=topics
        )
    bits, evaluators = EventBits(msrcn.eflows), EvaluatorFactory(plan, msrcn)
    rules = [(rule, Condition(rule.when, bits.by_name)) for rule in msrcn.rules]
    return Observations(
        rates=rates,
        mission=MissionMonitor(bits, rules),
        monitors=plan.fps_monitor,
        events=_event_sources(msrcn, bits, evaluators),
        actions=_action_evaluators(msrcn, evaluators),
        leases=leases,
        node=msrcn.id,
        publisher_topics=topics,
    )


def _command_leases(plan: Plan) -> dict[str, CommandLease]:
    """Return the leases of a plan by name; the publishers that need one are its commanders."""
    return {
        lease.name: CommandLease(
            lease.name,
            (
                Commander(flow.publisher, flow.rank)
                for grcn in plan.grcn
                if grcn.lease == lease.name
                for flow in grcn.flows
            ),
            lease.ttl,
            lease.service,
        )
        for lease in plan.leases
    }


def _publisher_topics(streams: Sequence[Stream]) -> PublisherTopics:
    """Return the private topics of the publishers that enforced streams have remapped."""
    return PublisherTopics(
        {
            (stream.topic, flow.publisher): flow_topic(stream.topic, flow.name)
            for stream in streams
            if stream.mode is Mode.ENFORCE
            for flow in stream.flows
        }
    )


def _event_sources(
    msrcn: MSRCN, bits: EventBits, evaluators: EvaluatorFactory
) -> tuple[EventSource, ...]:
    grouped: dict[tuple[str, str, str], list[EventFlow]] = defaultdict(list)
    for flow in msrcn.eflows:
        grouped[flow.topic, flow.publisher, normalise_type(flow.type)].append(flow)
    return tuple(_event_source(flows, bits, evaluators) for flows in grouped.values())


def _event_source(
    flows: Sequence[EventFlow], bits: EventBits, evaluators: EvaluatorFactory
) -> EventSource:
    first = flows[0]
    md5sum, evaluate = "", _always_true(len(flows))
    if any(flow.when for flow in flows):
        texts = [flow.when or "true" for flow in flows]
        md5sum, evaluate = evaluators.create(
            first.type, "event", texts, [flow.frame for flow in flows]
        )
    bits_of_flows = tuple(bits.by_name[flow.name] for flow in flows)
    return EventSource(first.topic, first.publisher, first.type, md5sum, bits_of_flows, evaluate)


def _always_true(flows: int) -> EvaluateMessage:
    counts = (True,) * flows
    return lambda message: counts


def action_evaluator(
    topic: GuardedTopic, rules: Sequence[MissionRule], evaluators: EvaluatorFactory
) -> ActionEvaluator:
    """Return the evaluator of the rules' `action` expressions for a topic."""
    texts, frames = [rule.action for rule in rules], [rule.frame for rule in rules]
    md5sum, evaluate = evaluators.create(topic.type, "action", texts, frames)
    return ActionEvaluator(md5sum, tuple(rule.name for rule in rules), evaluate)


def rules_reading(topic: GuardedTopic, msrcn: MSRCN) -> list[MissionRule]:
    """Return the rules whose `action` reads the messages of a topic."""
    names = {topic.topic, *(flow.name for flow in topic.flows)}
    return [rule for rule in msrcn.rules if rule.action and names.intersection(rule.block)]


def _action_evaluators(msrcn: MSRCN, evaluators: EvaluatorFactory) -> dict[str, ActionEvaluator]:
    topics = ((topic, rules_reading(topic, msrcn)) for topic in msrcn.aflows)
    return {
        topic.topic: action_evaluator(topic, rules, evaluators) for topic, rules in topics if rules
    }
