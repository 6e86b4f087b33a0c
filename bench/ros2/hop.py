"""The guard's hop on ROS 2 beside a relay in C and one of rclpy, and what it costs when idle."""

import time
from collections.abc import Iterator

from bench.common.hops import Hop, Peer, added, figures_of
from bench.common.process_usage import processor_ns
from bench.common.pubsub import Load, interleave, run_load
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import HOP_SECONDS, LOAD_SECONDS, RUNS
from bench.ros1.hop import FAST_RATE, IMAGE_RATE, RATE, TEN_MORE_US
from bench.ros2.routes import c_relay, direct, guard, parallel_relays, relay, staged
from figures.figure import Figure

FLOWS = 20
_IDLE_S = 10
_TWISTS = Load(RATE * HOP_SECONDS, RATE)


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give what a hop adds, the losses under load, and what an idle guard costs."""
    for hop in (_twists(), _images()):
        yield from figures_of(testbed, hop, progress)
    yield from _chain(testbed, progress)
    yield from _loads(testbed, progress)
    yield from _idle(testbed, progress)


def _twists() -> Hop:
    peers = [Peer(c_relay(), {"median": 1.2}), Peer(relay(), {"p99": 1.0})]
    return Hop("ros2.hop", _TWISTS, direct(), guard(), peers)


def _images() -> Hop:
    load = Load(IMAGE_RATE * HOP_SECONDS, IMAGE_RATE, message="image")
    peers = [Peer(c_relay("image")), Peer(relay("image"), {"median": 1.0, "p99": 1.0})]
    return Hop("ros2.images", load, direct(), guard("image"), peers)


def _chain(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield what ten coordination nodes on one stream add to one."""
    one, ten = staged(1), staged(10)
    runs = interleave(testbed, [one, ten], _TWISTS, RUNS, progress)
    more = added(runs[ten.name], runs[one.name], "median")
    yield Figure.of_runs("ros2.ten_more_than_one", more, (), "us", at_most=TEN_MORE_US)


def _loads(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    twists = Load(FAST_RATE * LOAD_SECONDS, FAST_RATE)
    images = Load(IMAGE_RATE * LOAD_SECONDS, IMAGE_RATE, message="image")
    loads = (
        ("twists", twists, guard(number=FLOWS), parallel_relays(FLOWS)),
        ("images", images, guard("image"), relay("image")),
    )
    for name, load, ours, peer in loads:
        progress(f"{name}, {LOAD_SECONDS} s each")
        mine, theirs = run_load(testbed, ours, load), run_load(testbed, peer, load)
        unit = f"messages of {load.count}"
        yield Figure(f"ros2.{name}_lost", mine.lost, theirs.lost, unit, at_most=0)
        yield Figure(f"ros2.{name}_generator_late", mine.late_ms, theirs.late_ms, "ms at most")


def _idle(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    progress(f"idle, {_IDLE_S} s each")
    ours, peer = (
        _idle_cpu(testbed, route) for route in (guard(number=FLOWS), parallel_relays(FLOWS))
    )
    yield Figure("ros2.idle_cpu", ours, peer, "% of a core", at_most=3)


def _idle_cpu(testbed: Testbed, route) -> float:  # noqa: ANN001
    """Return the processor time of a way that nobody uses, % of a core, once it has started."""
    with route.start(testbed) as process:
        time.sleep(_IDLE_S / 2)
        before = processor_ns(process.pid)
        time.sleep(_IDLE_S)
        return 100 * (processor_ns(process.pid) - before) / 1e9 / _IDLE_S
