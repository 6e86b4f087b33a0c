"""The policies of a stream's stages, each with the senses that it needs."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.guard.core.observations import Senses
from rtron.guard.core.override_policy import Overridable
from rtron.guard.core.velocity_adapter import Decoding
from rtron.policies import Policy, build
from rtron.policies.mission.rule_block import Judgement, RuleBlock
from rtron.policies.mission.rule_status import Standing
from rtron.policies.velocity_limit.limiter import Limiting
from rtron.vocabulary import CoordinationKind, Stage, Stream


def policy_of(
    stage: Stage, topic: str, senses: Senses, standings: Mapping[str, Standing] | None = None
) -> Policy:
    """Return what decides in a stage; all but a GRCN's can be overridden.

    `standings` are those of the mission once other rules are in force. PlanError if the settings
    cannot be.
    """
    if stage.coordination is CoordinationKind.GRCN:
        return build(stage.settings)
    if stage.coordination is CoordinationKind.MSRCN:
        action = senses.actions.get(topic)
        judge = action.judged if action else _nothing
        return Overridable(RuleBlock(stage.settings, senses.mission, judge, standings))
    policy = build(stage.settings, senses.rates)
    return Overridable(Decoding(policy) if isinstance(policy, Limiting) else policy)


def policies_of(stream: Stream, senses: Senses) -> dict[str, Policy]:
    """Return the policies of a stream's stages, in their order, by the coordination node."""
    return {stage.id: policy_of(stage, stream.topic, senses) for stage in stream.stages}


def changed_policies(
    before: Stream, after: Stream, senses: Senses, standings: Mapping[str, Standing]
) -> dict[str, Policy]:
    """Return the policies of the stages whose settings differ, by the coordination node."""
    return {
        stage.id: policy_of(stage, after.topic, senses, standings)
        for old, stage in zip(before.stages, after.stages, strict=True)
        if replace(stage.settings, revision=old.settings.revision) != old.settings
    }


def _nothing(_message: object) -> Mapping[str, Judgement]:
    return {}
