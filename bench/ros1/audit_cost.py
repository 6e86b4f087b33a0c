"""What the guard's audit of 40 nodes costs, and whether it delays messages.

Processor time is that of all the guard's threads; the nodes are relays of topic_tools, which listen
to its output.
"""

import time
from collections.abc import Iterator

from bench.audited import OUT, processor_ns, run_audited_guard
from bench.common.latency import median, typical_p99
from bench.common.pubsub import Load, LoadResult, run_load
from bench.common.testbed import Testbed
from bench.common.workload import AUDIT_SECONDS, HOP_MESSAGES, RUNS
from bench.part import ReportProgress
from bench.ros1.routes import PUBLISHER, Route
from figures.figure import Figure
from rtron.vocabulary import flow_topic

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
    load, found = Load(HOP_MESSAGES, _RATE), dict[bool, list[LoadResult]]({False: [], True: []})
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
