"""What the guard adds to the latency of Twists and images, beside relays in C++."""

from collections.abc import Iterator
from dataclasses import replace

from bench.common.hops import Hop, Peer, added, figures_of
from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER, Load, Route, interleave
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import HOP_SECONDS, RUNS
from bench.ros1.routes import direct, guard, guard_of, relays, staged
from figures.figure import Figure
from rtron.vocabulary import IncidentRecording, Plan

RATE = 200
"""Messages a second of each topic."""
FAST_RATE = 5000
TOPICS = 20
"""Topics that carry the fast messages together."""
IMAGE_RATE = 30
TEN_MORE_US = 15.0
"""What ten coordination nodes may add to one, us."""
_AT_MOST = {"median": 0.5, "p99": 1.0}
_NO_LATER = {"median": 1.0, "p99": 1.0}


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield the hops of 1, 5 and 20 topics, of fast messages and of images."""
    for number in (1, 5, TOPICS):
        load = Load(number * RATE * HOP_SECONDS, number * RATE)
        yield from figures_of(testbed, _twists(f"hop.{number}", load, number), progress)
    fast = Load(FAST_RATE * HOP_SECONDS, FAST_RATE)
    yield from figures_of(testbed, _twists("hop.fast", fast, TOPICS), progress)
    yield from figures_of(testbed, _images(), progress)


def _twists(name: str, load: Load, topics: int) -> Hop:
    nodes = (grcn(f"/cmd_vel_{index}", [PUBLISHER]) for index in range(topics))
    peer = Peer(relays(topics), _AT_MOST)
    return Hop(name, load, direct(topics), guard(*nodes), [peer])


def _images() -> Hop:
    load = Load(IMAGE_RATE * HOP_SECONDS, IMAGE_RATE, message="image")
    ours = guard(grcn("/image", [PUBLISHER], "sensor_msgs/Image"))
    return Hop("hop.images", load, direct(), ours, [Peer(relays(1), _NO_LATER)])


def chain_figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield what ten coordination nodes on one stream add to one."""
    one, ten = staged(1), staged(10)
    load = Load(RATE * HOP_SECONDS, RATE)
    runs = interleave(testbed, [one, ten], load, RUNS, progress)
    more = added(runs[ten.name], runs[one.name], "median")
    yield Figure.of_runs("chain.ten_more_than_one", more, (), "us", at_most=TEN_MORE_US)


def incident_figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Yield what a guard that records incidents adds to a command, beside one that does not."""
    load = Load(RATE * HOP_SECONDS, RATE)
    plan = Plan(app="bench", grcn=(grcn("/cmd_vel", [PUBLISHER]),))
    off = replace(plan, incidents=IncidentRecording(keep=0))
    ways = [direct(), _named("recording", plan), _named("not recording", off)]
    none, with_it, without = interleave(testbed, ways, load, RUNS, progress).values()
    for statistic in ("median", "p99"):
        more = [added(runs, none, statistic) for runs in (with_it, without)]
        yield Figure.of_runs(f"incidents.added_{statistic}_vs_not_recording", *more, "us")
    lost = [sum(run.lost for run in runs) for runs in (with_it, without)]
    yield Figure("incidents.lost", *lost, f"messages of {RUNS * load.count}", at_most=0)


def _named(name: str, plan: Plan) -> Route:
    return replace(guard_of(plan), name=name)
