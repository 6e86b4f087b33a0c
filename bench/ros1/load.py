"""Whether all arrives: 5,000 Twist/s over 20 flows, and apart from it 6 MB images at 30 Hz."""

from collections.abc import Iterator

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER, Load, LoadResult, Route, run_load
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import LOAD_SECONDS
from bench.ros1.routes import guard, relays
from figures.figure import Figure

FLOWS = 20
_TWISTS = Load(5000 * LOAD_SECONDS, 5000)
_IMAGES = Load(30 * LOAD_SECONDS, 30, message="image")


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give loss and order of each load."""
    topics = guard(*(grcn(f"/cmd_vel_{index}", [PUBLISHER]) for index in range(FLOWS)))
    images = guard(grcn("/image", [PUBLISHER], "sensor_msgs/Image"))
    yield from _compared(testbed, progress, "twists", _TWISTS, (topics, relays(FLOWS)))
    yield from _highest(testbed, progress)
    yield from _compared(testbed, progress, "images", _IMAGES, (images, relays()))


def _compared(
    testbed: Testbed, progress: ReportProgress, name: str, load: Load, routes: tuple[Route, Route]
) -> Iterator[Figure]:
    ours, peer = (_run(testbed, progress, name, route, load) for route in routes)
    unit = f"messages of {load.count}"
    yield Figure(f"load.{name}_lost", ours.lost, peer.lost, unit, at_most=0)
    yield Figure(f"load.{name}_disordered", ours.disordered, peer.disordered, unit, at_most=0)
    yield Figure(f"load.{name}_generator_late", ours.late_ms, peer.late_ms, "ms at most")


def _highest(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the loss of the highest of 20 flows on one topic, and what of the others passed."""
    route = guard(grcn("/cmd_vel", [f"{PUBLISHER}_{index}" for index in range(FLOWS)]))
    load = Load(_TWISTS.count, _TWISTS.rate, expected=_TWISTS.count // FLOWS)
    came = _run(testbed, progress, "one topic", route, load)
    passed = sum(sequence % FLOWS == 0 for sequence in came.sequences)
    unit = f"messages of {load.arriving}"
    yield Figure("load.highest_flow_lost", load.arriving - passed, None, unit, at_most=0)
    others = len(came.sequences) - passed
    yield Figure("load.lower_flows_passed", others, None, f"messages of {load.count}", at_most=0)


def _run(
    testbed: Testbed, progress: ReportProgress, name: str, route: Route, load: Load
) -> LoadResult:
    progress(f"{name} through {route.name}, {load.count // load.rate} s")
    return run_load(testbed, route, load)
