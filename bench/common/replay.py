"""How fast a recording is replayed: messages a second, of a ROS 1 bag and of a ROS 2 bag in MCAP.

Reading, Preemption and Constrain with decoding and encoding are in it. Of the ROS 1 bag, with two
publishers, Preemption drops half; all of the ROS 2 bag comes to Constrain, which changes half. The
peer is rosbags, which reads the same file and does nothing with the messages.
"""

import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from statistics import median

from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag2 import Reader as Reader2

from bench.common.testbed import Testbed
from bench.common.workload import REPLAYED
from bench.part import ReportProgress
from bench.recordings import plan, write_mcap, write_ros1
from figures.figure import Figure
from rtron.guard.replay.player import RecordingPlayer
from rtron.workflows.replay import GuardRecording

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
