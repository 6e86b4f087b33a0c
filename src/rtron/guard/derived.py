"""What follows from the settings of a stream."""

from dataclasses import replace

from rtron.guard.core.observations import Observations
from rtron.vocabulary import UNAPPROVED, Flow, Stage, Stream


def with_unapproved(stream: Stream) -> Stream:
    """Give the unapproved flow a place behind all others where the plan lets it through."""
    if stream.block_unapproved:
        return stream
    return replace(stream, stages=tuple(_with_unapproved_flow(stage) for stage in stream.stages))


def _with_unapproved_flow(stage: Stage) -> Stage:
    lowest_priority = min((flow.priority for flow in stage.settings.flows), default=0) - 1
    flow = Flow(name=UNAPPROVED, publisher="*", priority=lowest_priority)
    settings = replace(stage.settings, flows=(*stage.settings.flows, flow))
    return replace(stage, settings=settings)


def revision_of(stream: Stream) -> int:
    """Return the newest revision of the settings of a stream's stages."""
    return max((stage.settings.revision for stage in stream.stages), default=0)


def rules_md5sum(stream: Stream, observations: Observations) -> str:
    """Return the MD5 sum of the messages that the mission's rules look into, or nothing."""
    action = observations.actions.get(stream.topic)
    return action.md5sum if action else ""


def rules_met_by_flow(stream: Stream) -> dict[str, list[str]]:
    """Return the rules whose obligation a message that goes out meets, by its flow."""
    rules = [rule for stage in stream.stages for rule in stage.settings.rules]
    flows = {flow for rule in rules for flow in rule.required_flows}
    return {flow: [rule.name for rule in rules if flow in rule.required_flows] for flow in flows}
