"""The guard's data path on ROS 2 beside relays of rclpy: one hop, ten, and loads."""

import time
from collections.abc import Iterator

from bench.common.latency import median, p99
from bench.common.process_usage import processor_ns
from bench.common.pubsub import Load, interleave, run_load
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import HOP_MESSAGES, LOAD_SECONDS, RUNS
from bench.ros1.hop import RATE
from bench.ros2.routes import direct, guard, parallel_relays, relay
from figures.figure import Figure

FLOWS = 20
_IMAGE = "sensor_msgs/msg/Image"
_IDLE_S = 10


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the latencies of the whole way, the losses under load, and what an idle guard costs."""
    yield from _hops(testbed, progress)
    yield from _loads(testbed, progress)
    yield from _idle(testbed, progress)


def _hops(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    routes = [direct(), guard(), relay(), guard(stages=10), relay(10)]
    runs = interleave(testbed, routes, Load(HOP_MESSAGES, RATE), RUNS, progress)
    none, one, peer, ten, peers = (median(runs[route.name]) for route in routes)
    yield Figure("ros2.hop_whole_median", one, peer, "us", ratio_at_most=0.8)
    yield Figure("ros2.hop_whole_median_vs_direct", one, none, "us")
    yield Figure("ros2.hop_whole_p99", p99(runs["guard"]), p99(runs["relay"]), "us")
    yield Figure("ros2.ten_added_to_one", ten - one, peers - peer, "us", at_most=50)
    yield Figure("ros2.ten_added_median", ten - none, peers - none, "us", ratio_at_most=0.25)
    lost = {name: sum(run.lost for run in found) for name, found in runs.items()}
    yield Figure("ros2.hop_lost", lost["guard"], lost["relay"], "messages", at_most=0)


def _loads(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    twists = Load(5000 * LOAD_SECONDS, 5000)
    images = Load(30 * LOAD_SECONDS, 30, message="image")
    loads = (
        ("twists", twists, guard(number=FLOWS), parallel_relays(FLOWS)),
        ("images", images, guard(type=_IMAGE), relay(message="image")),
    )
    for name, load, ours, peer in loads:
        progress(f"{name}, {LOAD_SECONDS} s each")
        mine, theirs = run_load(testbed, ours, load), run_load(testbed, peer, load)
        unit = f"messages of {load.count}"
        yield Figure(f"ros2.{name}_lost", mine.lost, theirs.lost, unit, at_most=0)
        yield Figure(f"ros2.{name}_p99", p99([mine]), p99([theirs]), "us")
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
