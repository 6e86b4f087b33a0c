"""The policies of a stream's stages, each with the senses that it needs."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.guard.core.observations import Observations
from rtron.guard.core.override_policy import OverridablePolicy
from rtron.guard.core.velocity_adapter import VelocityAdapter
from rtron.policies import Policy, build_policy
from rtron.policies.mission.rule_block import RuleBlock, RuleResult
from rtron.policies.mission.rule_status import RuleStatus
from rtron.policies.velocity_limit.limiter import VelocityLimiter
from rtron.vocabulary import CoordinationKind, Stage, Stream


def create_policy(
    stage: Stage,
    topic: str,
    observations: Observations,
    rule_statuses: Mapping[str, RuleStatus] | None = None,
) -> Policy:
    """Return what decides in a stage; all but a GRCN's can be overridden.

    `rule_statuses` are those of the mission once other rules are in force. PlanError if the settings
    cannot be.
    """
    if stage.coordination_kind is CoordinationKind.GRCN:
        return build_policy(stage.settings)
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
