"""Actions behind the guard: what it adds to a goal, what a flood does, how statuses are read.

The ends are those of the tests, clients and servers of actionlib itself. The peer of a goal's ways
is no guard, in the same run; that of reading is rosbags.
"""

import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from rosbags.typesys import Stores, get_typestore

from bench.common.latency import quantile
from bench.common.process_usage import processor_ns
from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import GOALS, RUNS
from bench.ros1.action_endpoints import Load, compile_actions, master, run_both_routes
from figures.figure import Figure
from rtron.messages.common.encoding import PREFIX
from rtron.messages.ros1.actions import SUCCEEDED, GoalID, GoalStatus, read_statuses, with_statuses
from rtron.vocabulary import SECOND, PolicyName

_WARM_UP = 20
_MAX_AGE = SECOND
_STATUSES, _READS = 10_000, 15
_STATUS_ARRAY = "actionlib_msgs/msg/GoalStatusArray"
_NO_STATUSES = (20).to_bytes(PREFIX, "little") + bytes(20)
_NS_PER_MS = 1_000_000


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the ways of a goal, goals during a flood, and the reading of a status array."""
    progress("compiling the ends")
    programs = compile_actions(testbed.folder)
    yield from _goals(testbed, programs, progress)
    for policy in (PolicyName.FIFO_QUEUE, PolicyName.PRIORITY_QUEUE):
        progress(f"a thousand goals during a flood, {policy}")
        yield from _flooded(testbed, programs, policy)
    progress(f"reading {_STATUSES} statuses")
    yield from _reading()


def _goals(testbed: Testbed, programs: Any, progress: ReportProgress) -> Iterator[Figure]:  # noqa: ANN401 - of tests
    """Give median and p99 of a goal's way to its start, and of its result's way back."""
    with run_both_routes(testbed, programs) as routes:
        for endpoints in routes.values():
            endpoints.run(_WARM_UP)
            endpoints.starts.clear()
            endpoints.results.clear()
        for number in range(1, RUNS + 1):
            for name, endpoints in routes.items():
                progress(f"goals, {name}, run {number} of {RUNS}")
                endpoints.run(GOALS)
    yield from _compared("start", {name: endpoints.starts for name, endpoints in routes.items()})
    yield from _compared("end", {name: endpoints.results for name, endpoints in routes.items()})


def _compared(direction: str, times: Mapping[str, Sequence[int]]) -> Iterator[Figure]:
    ours, peer = sorted(times["guard"]), sorted(times["direct"])
    for part, share in (("median", 0.5), ("p99", 0.99)):
        found = quantile(ours, share), quantile(peer, share)
        yield Figure(f"actions.{direction}_{part}", *found, "us (peer: no guard)")


def _flooded(testbed: Testbed, programs: Any, policy: PolicyName) -> Iterator[Figure]:  # noqa: ANN401
    """Give what became of the goals, and the guard's processor time meanwhile."""
    name = f"actions.{policy.lower()}"
    with master(testbed, policy) as ros1:
        load = Load(ros1, programs, policy, server="cpp", max_age=_MAX_AGE)
        guard = load.act.guard_pid()
        used, flooded, began = processor_ns(guard), load.flooded(), time.monotonic_ns()
        load.run()
        spent, strange = processor_ns(guard) - used, load.flooded() - flooded
        took = time.monotonic_ns() - began
    outcomes = list(load.ends().values())
    unit = f"of {len(outcomes)} goals"
    for what in (load.answered_otherwise, load.late, load.touched):
        yield Figure(f"{name}.{what.__name__}", len(what()), None, unit, at_most=0)
    yield Figure(f"{name}.too_old", outcomes.count("RECALLED"), None, f"{unit}, recalled")
    yield Figure(f"{name}.strange", strange * SECOND / took, None, "messages a second")
    yield Figure(f"{name}.processor", 100 * spent / took, None, "% of a core, the guard")


def _reading() -> Iterator[Figure]:
    """Give how long a status array takes to read, in turn with rosbags."""
    message, store = _status_array(), get_typestore(Stores.ROS1_NOETIC)
    body = message[PREFIX:]
    ours, peer = [], []
    for _ in range(_READS):
        ours.append(_ms(lambda: read_statuses(message)))
        peer.append(_ms(lambda: store.deserialize_ros1(body, _STATUS_ARRAY)))
    found = statistics.median(ours), statistics.median(peer)
    unit = f"ms, {_STATUSES} goals (peer: rosbags)"
    yield Figure("actions.read_statuses", *found, unit, ratio_at_most=1)


def _status_array() -> bytes:
    ids = (GoalID(f"/client-{n}-1.5".encode(), n) for n in range(_STATUSES))
    return with_statuses(_NO_STATUSES, [GoalStatus(id, SUCCEEDED, "done") for id in ids])


def _ms(read: Callable[[], object]) -> float:
    began = time.perf_counter_ns()
    read()
    return (time.perf_counter_ns() - began) / _NS_PER_MS
