"""Which coordination node a verdict comes from: the pipeline does not keep it with each message."""

from rtron.vocabulary import CoordinationKind, PolicyName, Stage, Stream, Verdict

_RSRCN = (PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)


def stage_of(stream: Stream, verdict: Verdict) -> str:
    """Return the id of the stage that gave a verdict."""
    stages = (stage.id for stage in stream.stages if _is_from(stage, verdict))
    return next(stages, stream.stages[0].id)


def _is_from(stage: Stage, verdict: Verdict) -> bool:
    if verdict.policy in _RSRCN:
        return stage.coordination_kind is CoordinationKind.RSRCN
    if verdict.policy is not PolicyName.BLOCK:
        return stage.coordination_kind is CoordinationKind.GRCN
    if verdict.reason.startswith("rule "):
        return stage.coordination_kind is CoordinationKind.MSRCN
    return any(flow.name == verdict.flow and flow.block for flow in stage.settings.flows)
