"""What SROS2 costs: latency, processor time and start without it, with signatures, encrypted.

It needs an RMW with DDS-Security: Cyclone DDS, as `tests/ros2/cyclone_rmw.py` chooses it.
"""

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path

from bench.common.latency import median, p99
from bench.common.plans import grcn
from bench.common.process_usage import processor_ns
from bench.common.pubsub import PUBLISHER, Load, LoadResult, run_load
from bench.common.testbed import ReportProgress, Testbed, end, last_errors, python, start
from bench.ros2.messages import MESSAGES
from bench.ros2.routes import direct, guard
from figures.figure import Figure
from rtron.security.access.plan_rights import LAUNCH_PROCESS, guard_access
from rtron.security.access.rights import (
    AccessRight,
    AppAccess,
    NodeAccess,
    ProcessAccess,
    RightKind,
    node_rights,
)
from rtron.security.sros2.changes import KeystoreSettings, plan_changes
from rtron.security.sros2.documents import Protection
from rtron.security.sros2.layout import Keystore
from rtron.security.sros2.state import read_state
from rtron.security.sros2.writer import KeystoreWriter
from rtron.vocabulary import Plan

_RATE, _SECONDS, _RUNS = 100, 4, 5
_STARTED_S = 10
"""After so long the spare guard is ready, too."""
_LOAD = Load(_RATE * _SECONDS, _RATE)
_SENDING = "generator", ("--publish", f"{PUBLISHER}=/bench", "--rate", "1", "--burst", "1")
_MODES: Mapping[str, Protection | None] = {"none": None} | {str(p): p for p in Protection}


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give what each mode costs beside no protection; nothing without such an RMW."""
    if "cyclonedds" not in os.environ.get("RMW_IMPLEMENTATION", ""):
        return
    node = grcn("/bench_0", [PUBLISHER], MESSAGES["twist"].type)
    access = app_access(Plan(app="bench", ros=2, grcn=(node,)), ("/bench", "/bench_1"))
    testbeds = {n: secured(testbed, n, mode, access) for n, mode in _MODES.items()}
    runs: dict[tuple[str, str], list[LoadResult]] = {}
    starts: dict[str, list[float]] = {}
    for number in range(1, _RUNS + 1):
        for mode, bed in testbeds.items():
            for route in (direct(), guard()):
                progress(f"{mode}, {route.name}, run {number} of {_RUNS}")
                runs.setdefault((route.name, mode), []).append(run_load(bed, route, _LOAD))
            starts.setdefault(mode, []).append(_start_ms(bed))
    yield from _latencies(runs)
    for mode in _MODES:
        yield Figure.of_runs(f"ros2.security.start.{mode}", starts[mode], starts["none"], "ms")
    for mode, bed in testbeds.items():
        progress(f"{mode}, processor time")
        yield Figure(f"ros2.security.guard_cpu.{mode}", _guard_cpu(bed), None, "% of a core")


def _latencies(runs: Mapping[tuple[str, str], list[LoadResult]]) -> Iterator[Figure]:
    for (route, mode), results in runs.items():
        for name, of in (("median", median), ("p99", p99)):
            ours = [of([each]) for each in results]
            without = [of([each]) for each in runs[route, "none"]]
            yield Figure.of_runs(f"ros2.security.{route}.{name}.{mode}", ours, without, "us")
        lost = sum(each.lost for each in results)
        yield Figure(f"ros2.security.{route}.lost.{mode}", lost, None, "messages", at_most=0)


def _start_ms(testbed: Testbed) -> float:
    """Return how long it takes from the start of two processes to a message between them."""
    options = ("--count", "1", "--limit", "60", "--message", "twist")
    began = time.monotonic_ns()
    with ExitStack() as stack:
        for module, end_of in (("receiver", ("--subscribe", "/bench")), _SENDING):
            command = python(f"bench.ros2.{module}", *end_of, *options)
            process = start(testbed, command, piped=True)
            stack.callback(end, process)
            if module == "receiver":
                receiver = process
        if not receiver.stdout or receiver.stdout.readline() != "ready\n":
            raise TimeoutError(last_errors(testbed))
        return (time.monotonic_ns() - began) / 1e6


def _guard_cpu(testbed: Testbed) -> float:
    """Return the processor time of the guard's processes around a load, % of a core."""
    route = guard()
    with route.start(testbed) as supervisor:
        time.sleep(_STARTED_S)
        before, began = _family_ns(supervisor.pid), time.monotonic_ns()
        run_load(testbed, replace(route, start=lambda _: nullcontext()), _LOAD)
        used = _family_ns(supervisor.pid) - before
        return 100 * used / (time.monotonic_ns() - began)


def _family_ns(pid: int) -> int:
    """Return the processor time of a process and of all that it started, ns."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()
    return processor_ns(pid) + sum(_family_ns(int(each)) for each in children)


def secured(
    testbed: Testbed, name: str, protection: Protection | None, access: AppAccess
) -> Testbed:
    """Return the testbed with a keystore of its own; without one for no protection."""
    if protection is None:
        return testbed
    folder = testbed.folder / f"keystore_{name}"
    settings = KeystoreSettings(
        domain=int(testbed.environ["ROS_DOMAIN_ID"]),
        protection=protection,
        now=datetime.now(timezone.utc),
        life=timedelta(days=1),
    )
    keystore = Keystore(folder)
    state = read_state(keystore, settings.now)
    KeystoreWriter(keystore, settings).apply(state, plan_changes(state, access, settings))
    environ = {
        "ROS_SECURITY_ENABLE": "true",
        "ROS_SECURITY_STRATEGY": "Enforce",
        "ROS_SECURITY_KEYSTORE": str(folder),
    }
    return replace(testbed, environ={**testbed.environ, **environ})


def app_access(plan: Plan, topics: Sequence[str] = ()) -> AppAccess:
    """Return the guard's rights, and those of both ends of a plan's topics, in the enclave /."""
    ends_at = [*topics, *(each.topic for each in plan.grcn)]
    ends_at += [f"/rtron{each.topic}/*" for each in plan.grcn]
    kinds = (RightKind.PUBLISH, RightKind.SUBSCRIBE)
    rights = frozenset(AccessRight(kind, topic) for kind in kinds for topic in ends_at)
    ends = NodeAccess(node=PUBLISHER, rights=rights | frozenset(node_rights("/bench_*")))
    process = ProcessAccess(name=LAUNCH_PROCESS, nodes=(ends,))
    return AppAccess(app="bench", processes=(guard_access(plan), process))
