"""The guard's memory: after the start, after 100,000 and after 10 million messages."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bench.common.process_usage import resident_mb
from bench.common.pubsub import Route
from bench.common.testbed import ReportProgress, Testbed, python, result_of
from bench.common.workload import MEMORY_SECONDS, MESSAGES
from bench.ros1.node import guard_pid
from bench.ros1.routes import guard, relays
from figures.figure import Figure

_COUNTS = {"start": 1, "short": 100_000, "long": MESSAGES}
"""After how many messages memory is looked at; the first of them shows that the guard is there."""
_WINDOWS = {"guard": 64, "relay": 8}
"""Messages on their way at most; a relay loses more than ten."""
_AT_MOST_MB = 60.0
_GROWTH_MB = 2.0


@dataclass(frozen=True, slots=True)
class Mark:
    """Messages that went through and were lost so far, and the resident memory then, MB."""

    received: int
    lost: int
    size: float


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the resident memory at each mark and its growth; the relay's for the first ones."""
    peer = _marks(testbed, progress, relays(), ("start", "short"))
    ours = _marks(testbed, progress, guard(), tuple(_COUNTS))
    for name, mark in ours.items():
        beside = peer[name].size if name in peer else None
        unit = f"MB after {mark.received:,}"
        yield Figure(f"memory.{name}", mark.size, beside, unit, at_most=_AT_MOST_MB)
    growth = ours["long"].size - ours["short"].size
    yield Figure("memory.growth", growth, None, "MB from short to long", at_most=_GROWTH_MB)
    yield Figure("memory.lost", ours["long"].lost, None, "messages", at_most=0)


def _marks(
    testbed: Testbed, progress: ReportProgress, route: Route, names: Sequence[str]
) -> dict[str, Mark]:
    """Send through one guard or relay, and look at it at each mark."""
    marks: dict[str, Mark] = {}
    received = lost = 0
    with route.start(testbed) as process:
        for name in names:
            progress(f"{route.name}: {_COUNTS[name]:,} messages")
            result = _flood(testbed, route, _COUNTS[name] - received)
            received += result["received"]
            lost += result["lost"]
            pid = guard_pid(testbed.environ["ROS_MASTER_URI"]) or process.pid
            marks[name] = Mark(received, lost, resident_mb(pid))
    return marks


def _flood(testbed: Testbed, route: Route, count: int) -> dict[str, int]:
    """Send `count` messages, as many as get through in the time."""
    endpoint_options = ("--publish", route.inputs[0], "--subscribe", route.outputs[0])
    window = ("--window", str(_WINDOWS[route.name]), "--limit", str(MEMORY_SECONDS))
    count_option = ("--count", str(count))
    result: dict[str, int] = result_of(
        testbed, python("bench.ros1.flood", *endpoint_options, *window, *count_option)
    )
    return result
