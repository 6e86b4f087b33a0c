"""The bags that are replayed: two publishers of one velocity, and what a plan makes of them."""

import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from bench.common.plans import TWIST, grcn
from rtron.vocabulary import RSRCN, SECOND, GuardedTopic, Mode, Plan, PolicyName

TOPIC = "/cmd_vel"
PUBLISHERS = ("/safe_control", "/move_base")
_PERIOD = SECOND // 100
_BODY = struct.Struct("<6d")
_CDR = b"\x00\x01\x00\x00"
_TYPE = "geometry_msgs/msg/Twist"


def plan(ros: int) -> Plan:
    """Return a plan with Preemption and Constrain; half of the velocities are above the limit.

    Bags of ROS 2 do not tell who published, so there its plan has one publisher for all.
    """
    publishers = PUBLISHERS if ros == 1 else PUBLISHERS[:1]
    node = grcn(TOPIC, publishers)
    limited = GuardedTopic(
        topic=TOPIC,
        type=TWIST,
        flows=tuple(replace(flow, priority=0) for flow in node.flows),
        successors=node.successors,
    )
    rsrcn = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=0.5,
        vflows=(limited,),
    )
    return Plan(app="bench", ros=ros, grcn=(node,), rsrcn=rsrcn)


def write_ros1(path: Path, count: int) -> None:
    """Write a ROS 1 bag of `count` Twists by two publishers in turn."""
    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer1(path) as writer:
        streams = [
            writer.add_connection(TOPIC, _TYPE, typestore=store, callerid=node)
            for node in PUBLISHERS
        ]
        for number, (time, body) in enumerate(_twists(count)):
            writer.write(streams[number % 2], time, body)


def write_mcap(folder: Path, count: int) -> None:
    """Write the same Twists as a ROS 2 bag in MCAP."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer2(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        stream = writer.add_connection(TOPIC, _TYPE, typestore=store)
        for time, body in _twists(count):
            writer.write(stream, time, _CDR + body)


def _twists(count: int) -> Iterator[tuple[int, bytes]]:
    """Yield time (ns) and body; both publishers have every speed from 0 to twice the limit."""
    for number in range(count):
        yield SECOND + number * _PERIOD, _BODY.pack(number // 2 % 200 / 200, 0, 0, 0, 0, 0.25)
