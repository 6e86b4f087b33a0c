"""The events, actions and rules that are measured."""

import struct
from collections.abc import Sequence

from rosbags.typesys import Stores, get_typestore

from bench.common.plans import SUBSCRIBER
from bench.ros1.messages import PREFIX, Message
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import (
    MSRCN,
    Area,
    EventFlow,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    Point,
    PolicyName,
)

EVENT, EVENT_NODE = "/bench_pose", "/bench_localization"
GOAL, GOAL_NODE = "/bench_goal", "/bench_planner"
_FRAME = b"map"
_HEADER = struct.Struct(f"<IIII{len(_FRAME)}s")
_POSE = struct.Struct("<7d")
_SQUARE = ((2.0, 0.0), (4.0, 0.0), (4.0, 2.0), (2.0, 2.0))
AREA = Area(name="area", frame="map", polygon=tuple(Point(x=x, y=y) for x, y in _SQUARE))


def pose_type() -> Message:
    """Return geometry_msgs/PoseStamped as a publisher declares it."""
    store = get_typestore(Stores.ROS1_NOETIC)
    text, md5sum = store.generate_msgdef("geometry_msgs/msg/PoseStamped")
    return Message("geometry_msgs/PoseStamped", md5sum, text, _HEADER.size + _POSE.size)


def pose(x: float, y: float) -> bytes:
    """Return a framed PoseStamped in the frame `map`."""
    head = _HEADER.pack(0, 0, 0, len(_FRAME), _FRAME)
    body = head + _POSE.pack(x, y, 0, 0, 0, 0, 1)
    return PREFIX.pack(len(body)) + body


def peer(node: str) -> Peer:
    """Return a publisher of poses as the guard sees it."""
    type = pose_type()
    return Peer(node, TypeInfo(type.type, type.md5sum, type.definition))


def plan(rules: Sequence[MissionRule], expressions: Sequence[str] = ()) -> Plan:
    """Return a plan of rules about goals; each expression over the events is an eflow."""
    goals = GuardedTopic(
        topic=GOAL,
        type="geometry_msgs/PoseStamped",
        flows=(Flow(name="aflow1", publisher=GOAL_NODE),),
        successors=(SUBSCRIBER,),
    )
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(goals,),
        eflows=tuple(_eflow(number, each) for number, each in enumerate(expressions, start=1)),
        rules=tuple(rules),
        areas=(AREA,),
    )
    return Plan(app="bench", msrcn=msrcn)


def _eflow(number: int, expression: str) -> EventFlow:
    return EventFlow(
        name=f"eflow{number}",
        topic=EVENT,
        publisher=EVENT_NODE,
        type="geometry_msgs/PoseStamped",
        when=expression,
    )
