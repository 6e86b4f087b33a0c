"""What the guard learns beside the streams: the app's events and frame rates, as the plan says."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rtron.guard.judging import Judges, Judging
from rtron.messages.expressions.condition import Condition
from rtron.policies.mission.event_bits import Bit, Bits
from rtron.policies.mission.rule_block import Judgement
from rtron.policies.mission.rule_status import Mission
from rtron.policies.velocity_limit.frame_monitors import Rates
from rtron.vocabulary import MSRCN, EventFlow, FpsMonitor, GuardedTopic, Plan, Rule, normalise_type

MAX_EVENT = 1 << 20
"""The longest event that an expression looks into, bytes: all other streams wait meanwhile."""


@dataclass(frozen=True, slots=True, eq=False)
class EventSource:
    """A publisher's topic, and the bits that its messages set; `md5sum` is "" where any will do."""

    topic: str
    publisher: str
    type: str
    md5sum: str
    bits: tuple[Bit, ...]
    judge: Judging

    def judged(self, message: bytes) -> Sequence[Judgement]:
        """Return what a message says about each bit, or why that cannot be told."""
        if len(message) > MAX_EVENT and self.md5sum:
            return (f"a message of {len(message)} bytes is too long to look into",) * len(self.bits)
        return self.judge(message)


@dataclass(frozen=True, slots=True, eq=False)
class ActionJudge:
    """Judges the messages of a topic by the rules that look into them."""

    md5sum: str
    rules: tuple[str, ...]
    judge: Judging

    def judged(self, message: object) -> Mapping[str, Judgement]:
        """Return what each rule's `action` says about a message."""
        return dict(zip(self.rules, self.judge(message), strict=True))  # type: ignore[arg-type]


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """The state that the policies of all streams share, and where it comes from."""

    rates: Rates = field(default_factory=Rates)
    mission: Mission = field(default_factory=lambda: Mission(Bits()))
    monitors: tuple[FpsMonitor, ...] = ()
    events: tuple[EventSource, ...] = ()
    actions: Mapping[str, ActionJudge] = field(default_factory=dict)
    node: str = "msrcn"

    def catch_up(self, now: int) -> None:
        """Let what has changed by time alone be known."""
        self.mission.catch_up(now)

    def deadline(self, now: int) -> int | None:
        """Return when something next changes if nothing more is heard."""
        times = (self.mission.due, self.rates.deadline(now))
        return min((time for time in times if time is not None), default=None)


def senses_of(plan: Plan) -> Senses:
    """Return what a plan's RSRCN and MSRCN ask for; PlanError if an expression cannot be used."""
    rates = Rates(plan.fps_monitor)
    msrcn = plan.msrcn
    if msrcn is None:
        return Senses(rates=rates, monitors=plan.fps_monitor)
    bits, judges = Bits(msrcn.eflows), Judges(plan, msrcn)
    rules = [(rule, Condition(rule.when, bits.named)) for rule in msrcn.rules]
    return Senses(
        rates=rates,
        mission=Mission(bits, rules),
        monitors=plan.fps_monitor,
        events=_events(msrcn, bits, judges),
        actions=_actions(msrcn, judges),
        node=msrcn.id,
    )


def _events(msrcn: MSRCN, bits: Bits, judges: Judges) -> tuple[EventSource, ...]:
    grouped: dict[tuple[str, str, str], list[EventFlow]] = defaultdict(list)
    for flow in msrcn.eflows:
        grouped[flow.topic, flow.publisher, normalise_type(flow.type)].append(flow)
    return tuple(_event(flows, bits, judges) for flows in grouped.values())


def _event(flows: Sequence[EventFlow], bits: Bits, judges: Judges) -> EventSource:
    first = flows[0]
    md5sum, judge = "", _each_counts(len(flows))
    if any(flow.when for flow in flows):
        texts = [flow.when or "true" for flow in flows]
        md5sum, judge = judges.make(first.type, "event", texts, [flow.frame for flow in flows])
    named = tuple(bits.named[flow.name] for flow in flows)
    return EventSource(first.topic, first.publisher, first.type, md5sum, named, judge)


def _each_counts(flows: int) -> Judging:
    counts = (True,) * flows
    return lambda message: counts


def action_judge(topic: GuardedTopic, rules: Sequence[Rule], judges: Judges) -> ActionJudge:
    """Return what judges the messages of a topic by the `action` of rules."""
    texts, frames = [rule.action for rule in rules], [rule.frame for rule in rules]
    md5sum, judge = judges.make(topic.type, "action", texts, frames)
    return ActionJudge(md5sum, tuple(rule.name for rule in rules), judge)


def looking_into(topic: GuardedTopic, msrcn: MSRCN) -> list[Rule]:
    """Return the rules that look into the messages of a topic."""
    named = {topic.topic, *(flow.name for flow in topic.flows)}
    return [rule for rule in msrcn.rules if rule.action and named.intersection(rule.block)]


def _actions(msrcn: MSRCN, judges: Judges) -> dict[str, ActionJudge]:
    looking = ((topic, looking_into(topic, msrcn)) for topic in msrcn.aflows)
    return {topic.topic: action_judge(topic, rules, judges) for topic, rules in looking if rules}
