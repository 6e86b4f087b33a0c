"""How fast a recording is replayed: messages a second, of a ROS 1 bag and of a ROS 2 bag in MCAP.

Reading, Preemption and Constrain with decoding and encoding are in it. Of the ROS 1 bag, with two
publishers, Preemption drops half; all of the ROS 2 bag comes to Constrain, which changes half. The
peer is rosbags, which reads the same file and does nothing with the messages.
"""

import struct
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median

from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import Reader as Reader2
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from bench.common.plans import TWIST, grcn
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import REPLAYED
from figures.figure import Figure
from rtron.guard.replay.player import RecordingPlayer
from rtron.vocabulary import RSRCN, SECOND, GuardedTopic, Mode, Plan, PolicyName
from rtron.workflows.replay import GuardRecording

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


_REPEATS = 3
_AT_LEAST = 50_000
_UNIT = "messages/s (more is better)"


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the median rate of both, messages a second."""
    bag, folder = testbed.folder / "replay.bag", testbed.folder / "replay"
    progress(f"write {REPLAYED:,} messages")
    write_ros1(bag, REPLAYED)
    write_mcap(folder, REPLAYED)
    for name, path, ros, reader in (("ros1", bag, 1, Reader1), ("mcap", folder, 2, Reader2)):
        progress(name)
        ours, peer = _rates(partial(_play, path, ros), partial(_read, reader, path))
        yield Figure(f"replay.{name}", ours, peer, _UNIT, at_least=_AT_LEAST)


def _rates(*readers: Callable[[], int]) -> Iterator[float]:
    """Yield the median rate of each way, messages a second; they run in turn."""
    rates = [[_rate(reader) for reader in readers] for _ in range(_REPEATS)]
    yield from map(median, zip(*rates, strict=True))


def _rate(read: Callable[[], int]) -> float:
    start = time.perf_counter()
    messages = read()
    seconds = time.perf_counter() - start
    if messages != REPLAYED:
        raise AssertionError(f"{messages} of {REPLAYED} messages were replayed")
    return messages / seconds


def _play(bag: Path, ros: int) -> int:
    """Replay a bag; return how many messages the policies decided about."""
    found = RecordingPlayer(plan(ros)).play(GuardRecording(bag).messages(ros), lambda count: None)
    flows = [flow for flow in found.streams[0].flows if flow.publisher]
    decided = [flow.passed + flow.modified + flow.dropped for flow in flows]
    if not all(decided):
        raise AssertionError("a publisher's messages are not taken for its own")
    return sum(decided)


def _read(reader: Callable[[Path], Reader1 | Reader2], bag: Path) -> int:
    with reader(bag) as opened:
        return sum(1 for _ in opened.messages())
