"""Streams and peers for the guard's tests."""

from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import (
    CoordinationKind,
    Flow,
    Mode,
    OnSilence,
    PolicyName,
    PolicySettings,
    Stage,
    Stream,
    StreamKind,
)

TWIST = TypeInfo("geometry_msgs/Twist", "9f195f881246fdfa2798d1d3eebca84a", "")
WORDS = TypeInfo("my_msgs/Words", "0123456789abcdef0123456789abcdef", "")
"""A type that nobody reads: its messages may be any bytes."""
FLOWS = (
    Flow(name="flow1", publisher="/nav", priority=2, on_silence=OnSilence.RELEASE),
    Flow(name="flow2", publisher="/teleop", priority=1, on_silence=OnSilence.RELEASE),
)


def stage(
    id: str = "grcn_cmd_vel",
    policy: PolicyName = PolicyName.PREEMPTION,
    flows: tuple[Flow, ...] = FLOWS,
    kind: StreamKind = StreamKind.COMMAND,
    **settings: int,
) -> Stage:
    return Stage(
        id=id,
        coordination_kind=CoordinationKind.GRCN,
        settings=PolicySettings(policy=policy, kind=kind, flows=flows, **settings),
    )


def stream(
    *stages: Stage,
    topic: str = "/cmd_vel",
    type: str = TWIST.type,
    mode: Mode = Mode.ENFORCE,
    flows: tuple[Flow, ...] = FLOWS,
    successors: tuple[str, ...] = ("/driver",),
    **more: object,
) -> Stream:
    return Stream(
        topic=topic,
        type=type,
        mode=mode,
        flows=flows,
        stages=stages or (stage(),),
        successors=successors,
        **more,
    )


def peer(
    node: str, info: TypeInfo = TWIST, *, latching: bool = False, verified: bool = True
) -> Peer:
    return Peer(node, info, latching, verified)
