"""What the guard's audit of 40 nodes costs, and whether it delays messages.

Processor time is that of all the guard's threads; the nodes are relays of topic_tools, which listen
to its output.
"""

import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace

from bench.common.latency import median, typical_p99
from bench.common.plans import SUBSCRIBER, grcn
from bench.common.process_usage import processor_ns
from bench.common.pubsub import PUBLISHER, Load, LoadResult, Route, run_load
from bench.common.testbed import ReportProgress, Testbed, last_errors, python, running
from bench.common.workload import AUDIT_SECONDS, HOP_SECONDS, RUNS
from figures.figure import Figure
from rtron.errors import RTronError
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan, flow_topic, output_topic
from rtron.wire.ros1.xmlrpc import ros_call

TOPIC = "/cmd_vel"
OUT = output_topic(TOPIC)
_RELAY = "/usr/lib/topic_tools/relay"
_START_S = 60.0


@contextmanager
def run_audited_guard(
    testbed: Testbed, number: int, *, audit: bool
) -> Iterator[subprocess.Popen[str]]:
    """Run so many relays behind a guard, with its audit or without; give the guard's process."""
    names = [f"/audited_{index}" for index in range(number)]
    node = replace(grcn(TOPIC, [PUBLISHER]), successors=(SUBSCRIBER, *names))
    path = testbed.folder / "audited.yaml"
    path.write_text(write_plan(Plan(app="bench", grcn=(node,))), encoding="utf-8")
    with ExitStack() as stack:
        guard_command = python(
            "bench.ros1.guard_process", str(path), *(["--audit"] if audit else [])
        )
        guard = stack.enter_context(running(testbed, guard_command))
        for name in names:
            relay = [_RELAY, OUT, f"{name}_heard", f"__name:={name[1:]}"]
            stack.enter_context(running(testbed, relay, signal.SIGINT))
        _wait_for(testbed, number)
        yield guard


def _wait_for(testbed: Testbed, number: int) -> None:
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if _subscriber_count(testbed.environ["ROS_MASTER_URI"]) >= number:
            return
        time.sleep(0.1)
    raise TimeoutError(f"the audited nodes do not start\n{last_errors(testbed)}")


def _subscriber_count(master: str) -> int:
    """Return how many nodes have subscribed the guard's output."""
    try:
        state = ros_call(master, "getSystemState", "/bench", timeout=5)
    except RTronError:
        return 0
    return len(dict(state[1]).get(OUT, []))


_NODES = 40
_AT_MOST_PERCENT = 2.0
_RATE = 200


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the processor time and the latency of a hop, with the audit and without."""
    yield from _costs(testbed, progress)
    yield from _delays(testbed, progress)


def _costs(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    shares = {}
    for audit in (False, True):
        progress(f"{_NODES} nodes, {'audited' if audit else 'not audited'}")
        with run_audited_guard(testbed, _NODES, audit=audit) as guard:
            time.sleep(3.0)
            used, began = processor_ns(guard.pid), time.monotonic_ns()
            time.sleep(AUDIT_SECONDS)
            spent = processor_ns(guard.pid) - used
            shares[audit] = 100 * spent / (time.monotonic_ns() - began)
    unit = f"% of a core, {_NODES} nodes (peer: no audit)"
    yield Figure("audit.processor", shares[True], shares[False], unit)
    added = shares[True] - shares[False]
    yield Figure("audit.processor_added", added, None, "% of a core", at_most=_AT_MOST_PERCENT)


def _delays(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give one hop's latency with 40 nodes, audited and not, the runs in turn."""
    load, found = (
        Load(_RATE * HOP_SECONDS, _RATE),
        dict[bool, list[LoadResult]]({False: [], True: []}),
    )
    for number in range(RUNS):
        for audit, runs in found.items():
            progress(f"hop, {'audited' if audit else 'not audited'}, run {number + 1} of {RUNS}")
            runs.append(run_load(testbed, _guard_route(audit=audit), load))
    for name, statistic in (("median", median), ("typical_p99", typical_p99)):
        ours, peer = statistic(found[True]), statistic(found[False])
        yield Figure(f"audit.hop_{name}", ours, peer, "us (peer: no audit)")
    yield Figure("audit.hop_lost", sum(r.lost for r in found[True]), None, "messages", at_most=0)


def _guard_route(*, audit: bool) -> Route:
    inputs = [f"{PUBLISHER}={flow_topic('/cmd_vel', 'flow1')}"]
    return Route(
        "guard", inputs, [OUT], lambda testbed: run_audited_guard(testbed, _NODES, audit=audit)
    )
