"""From the guard's death to the stop at the driver, and until the guard is back.

A velocity flows at 100 Hz, a flow that is blocked and a publisher that the plan does not know speak
as often, and the guard is killed, stopped, or refused any more memory. The times run from just
before the signal, or the new limit, to when the driver has received the first message slower than
the velocity, and then the velocity again. No message of the other two may ever come.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from bench.common.latency import quantile
from bench.common.plans import grcn
from bench.common.process_usage import resident_mb
from bench.common.testbed import ReportProgress, Testbed, python, result_of, run_guard
from bench.common.workload import DEATHS
from bench.ros1.guard_killer import BLOCKED, CAUSES, COMMANDER, TOPIC
from figures.figure import Figure
from rtron.vocabulary import Plan

_STOP_MS = 100.0
_BACK_MS = 3000.0
_AT_MOST_MB = 40.0
_US_PER_MS = 1000


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give median, p99 and maximum of both times, ms, for each cause; and the memory."""
    with run_guard(testbed, _plan()) as process:
        for cause in CAUSES:
            progress(f"{DEATHS} times: {cause}")
            command = python("bench.ros1.guard_killer", "--cause", cause, "--rounds", str(DEATHS))
            found: dict[str, list[int]] = result_of(testbed, command)
            yield from _times(f"supervisor.{cause}.stop", found["stop"], _STOP_MS)
            yield from _times(f"supervisor.{cause}.back", found["back"], _BACK_MS)
            came = len(found["unchecked"])
            yield Figure(f"supervisor.{cause}.unchecked", came, None, "messages", at_most=0)
        size = resident_mb(process.pid)
        yield Figure("supervisor.memory", size, None, "MB", at_most=_AT_MOST_MB)
        yield Figure("supervisor.cpu", _load_of(process.pid), None, "% of a core, all the time")


def _times(name: str, times: list[int], at_most: float) -> Iterator[Figure]:
    ordered = sorted(times)
    for part, share, bound in (("median", 0.5, None), ("p99", 0.99, at_most), ("max", 1.0, None)):
        late = quantile(ordered, share) / _US_PER_MS
        yield Figure(f"{name}.{part}", late, None, f"ms of {len(times)}", at_most=bound)


def _plan() -> Plan:
    node = grcn(TOPIC, [COMMANDER, BLOCKED])
    mover, blocked = node.flows
    return Plan(app="bench", grcn=(replace(node, flows=(mover, replace(blocked, block=True))),))


def _load_of(pid: int) -> float:
    """Return the share of a core that a process has used since it was started, %."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    used = sum(map(int, fields[11:13]))
    began = int(fields[19])
    now = float(Path("/proc/uptime").read_text().split()[0]) * 100
    return 100 * used / (now - began)
