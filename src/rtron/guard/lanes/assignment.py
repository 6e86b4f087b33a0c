"""Which process of the guard carries a stream: what can move the robot has one of its own."""

from dataclasses import replace

from rtron.vocabulary import (
    BULK_NODE,
    CoordinationKind,
    Plan,
    Stream,
    StreamKind,
    build_streams,
    stage_nodes,
)


def command_part(plan: Plan) -> Plan:
    """Return what the command process carries of a plan: all that can move the robot.

    A coordination node lives in one process, so this has every topic of the RSRCN and the MSRCN.
    """
    bulk = _bulk_topics(plan)
    return replace(plan, grcn=tuple(each for each in plan.grcn if each.topic not in bulk))


def bulk_part(plan: Plan) -> Plan:
    """Return what the bulk process carries: states and sensor data, frames and events."""
    msrcn = plan.msrcn and replace(plan.msrcn, aflows=(), rules=())
    bulk = _bulk_topics(plan)
    grcn = tuple(each for each in plan.grcn if each.topic in bulk)
    return replace(plan, grcn=grcn, msrcn=msrcn, rsrcn=None)


def _bulk_topics(plan: Plan) -> frozenset[str]:
    streams = build_streams(plan)
    moving = {stream.topic for stream in streams if _moves_robot(stream)}
    return frozenset(stream.topic for stream in streams) - moving


def _moves_robot(stream: Stream) -> bool:
    return bool(stream.action or stream.done) or any(
        stage.coordination_kind is not CoordinationKind.GRCN
        or stage.settings.kind is not StreamKind.STATE
        for stage in stream.stages
    )


def lane_nodes(plan: Plan) -> tuple[frozenset[str], frozenset[str]]:
    """Return the nodes of the command process and those of the bulk process, without monitors'."""
    command, bulk = (
        {node for stream in build_streams(part) for node in stage_nodes(stream)}
        for part in (command_part(plan), bulk_part(plan))
    )
    return frozenset(command), frozenset(bulk | {BULK_NODE})
