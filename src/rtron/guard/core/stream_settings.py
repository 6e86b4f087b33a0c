"""The policies of a stream's settings, and updates: prepared first, then applied at once."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from rtron.errors import PlanError
from rtron.guard.core.observations import Observations
from rtron.guard.core.override_policy import OverridablePolicy
from rtron.guard.core.velocity_adapter import VelocityAdapter
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies import Policy, build_policy
from rtron.policies.mission.rule_block import RuleBlock, RuleResult
from rtron.policies.mission.rule_status import RuleStatus
from rtron.policies.velocity_limit.limiter import VelocityLimiter
from rtron.vocabulary import UNAPPROVED, CoordinationKind, Flow, Mode, Stage, Stream


def create_policy(
    stage: Stage,
    topic: str,
    observations: Observations,
    rule_statuses: Mapping[str, RuleStatus] | None = None,
) -> Policy:
    """Return the policy of a stage; all but a GRCN's can be overridden.

    `rule_statuses` are those of the mission once other rules are in force. PlanError if the
    settings cannot be used.
    """
    if stage.coordination_kind is CoordinationKind.GRCN:
        return build_policy(stage.settings, leases=observations.leases)
    if stage.coordination_kind is CoordinationKind.MSRCN:
        evaluator = observations.actions.get(topic)
        evaluate = evaluator.judgements_of if evaluator else _no_judgements
        return OverridablePolicy(
            RuleBlock(stage.settings, observations.mission, evaluate, rule_statuses)
        )
    policy = build_policy(stage.settings, observations.rates)
    return OverridablePolicy(
        VelocityAdapter(policy) if isinstance(policy, VelocityLimiter) else policy
    )


def create_policies(stream: Stream, observations: Observations) -> dict[str, Policy]:
    """Return the policies of a stream's stages, in their order, by the coordination node."""
    return {stage.id: create_policy(stage, stream.topic, observations) for stage in stream.stages}


def changed_policies(
    before: Stream,
    after: Stream,
    observations: Observations,
    rule_statuses: Mapping[str, RuleStatus],
) -> dict[str, Policy]:
    """Return the policies of the stages whose settings differ, by the coordination node."""
    return {
        stage.id: create_policy(stage, after.topic, observations, rule_statuses)
        for old, stage in zip(before.stages, after.stages, strict=True)
        if replace(stage.settings, revision=old.settings.revision) != old.settings
    }


def _no_judgements(_message: object) -> Mapping[str, RuleResult]:
    return {}


def with_unapproved(stream: Stream) -> Stream:
    """Add the unapproved flow behind all others where the plan lets it through."""
    if stream.block_unapproved:
        return stream
    return replace(stream, stages=tuple(_with_unapproved_flow(stage) for stage in stream.stages))


def with_queue_space(stream: Stream) -> Stream:
    """Let the queue have room for every flow's share, which is bounded before it."""
    first, *others = stream.stages
    size = stream.queue_size * (len(stream.flows) + 1)
    first = replace(first, settings=replace(first.settings, queue_size=size))
    return replace(stream, stages=(first, *others))


def with_defaults(stream: Stream) -> Stream:
    """Return a stream with all that the guard adds to the plan."""
    stream = with_unapproved(stream)
    is_action = stream.action and stream.mode is Mode.ENFORCE
    return with_queue_space(stream) if is_action else stream


def _with_unapproved_flow(stage: Stage) -> Stage:
    lowest_priority = min((flow.priority for flow in stage.settings.flows), default=0) - 1
    flow = Flow(name=UNAPPROVED, publisher="*", priority=lowest_priority)
    settings = replace(stage.settings, flows=(*stage.settings.flows, flow))
    return replace(stage, settings=settings)


def revision_of(stream: Stream) -> int:
    """Return the newest revision of the settings of a stream's stages."""
    return max((stage.settings.revision for stage in stream.stages), default=0)


def rules_md5sum(stream: Stream, observations: Observations) -> str:
    """Return the MD5 sum of the message type that the mission's rules read, or ""."""
    action = observations.actions.get(stream.topic)
    return action.md5sum if action else ""


def rules_met_by_flow(stream: Stream) -> dict[str, list[str]]:
    """Return the rules whose obligation a message that goes out meets, by its flow."""
    rules = [rule for stage in stream.stages for rule in stage.settings.rules]
    flows = {flow for rule in rules for flow in rule.required_flows}
    return {flow: [rule.name for rule in rules if flow in rule.required_flows] for flow in flows}


@dataclass(frozen=True, slots=True)
class StreamUpdate:
    """Other settings of a stream, ready to be put in force.

    `policies` are those that change, by the coordination node; `md5sum` is that of the message type
    that rules read, "" for any.
    """

    stream: Stream
    policies: Mapping[str, Policy]
    md5sum: str


@dataclass(frozen=True, slots=True)
class MessageFormat:
    """The type of a stream's messages and their codec, as far as they are known."""

    info: TypeInfo | None
    codec: VelocityCodec | None


def prepare_update(
    before: Stream,
    after: Stream,
    observations: Observations,
    rule_statuses: Mapping[str, RuleStatus],
    format: MessageFormat,
) -> StreamUpdate:
    """Return an update to other settings of a stream; PlanError if they cannot be used."""
    md5sum = rules_md5sum(after, observations)
    if format.info and md5sum not in ("", format.info.md5sum):
        text = f"{after.topic}: its messages are of another version than the rules read"
        raise PlanError(text)
    policies = changed_policies(before, after, observations, rule_statuses)
    for policy in policies.values():
        if format.codec and isinstance(policy, OverridablePolicy):
            policy.learn(format.codec)
    return StreamUpdate(after, policies, md5sum)
