"""What reaches the base of an intruder at 200 Hz, and what of the app does, on ROS 2.

Under Enforce only with an RMW that has DDS-Security: Cyclone DDS, as `tests/ros2/cyclone_rmw.py`
chooses it.
"""

import os
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from bench.cell.celled_route import cell_command
from bench.common.intrusion import INTRUDER, NAVIGATION, BaseLog, intrusion_plan
from bench.common.prevention import Outcome, app_share, outcome_figures
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import ReportProgress, Testbed, open_testbed, python, running
from bench.common.workload import PREVENTIONS
from bench.ros2.audit import FLOW, OUT
from bench.ros2.intrusion import PROCESSES, intruding, wait_for_navigation
from bench.ros2.security import app_access, secured
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan
from rtron.security.sros2.documents import Protection
from rtron.vocabulary import SECOND

_RATE, _ATTACK_S = 200, 5.0
_SETTLE_S = 2.0
"""So long the app drives before it is attacked."""
_ATTACKS = {
    "private": ("/bench_rogue", OUT),
    "guard_name": ("/rtron/grcn_cmd_vel", OUT),
    "planned_name": (PUBLISHER, FLOW),
}
"""The intruder's node name, and where it publishes."""
_ENFORCED = "enforce"
_PROTECTIONS = ("guard", "cell", _ENFORCED)


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give what each attack does to an app with a guard, with a cell too, and under Enforce."""
    del testbed  # each run has a domain of its own
    has_security = "cyclonedds" in os.environ.get("RMW_IMPLEMENTATION", "")
    if not has_security:
        progress("enforce is left out: the RMW has no DDS-Security")
    for protection in _PROTECTIONS[: None if has_security else -1]:
        for attack, (node, topic) in _ATTACKS.items():
            progress(f"{protection}, {attack}, {PREVENTIONS} times")
            run = partial(_run, protection, intruding(_RATE, node, topic))
            name = f"ros2_prevention.{protection}.{attack}"
            yield from outcome_figures(name, [run() for _ in range(PREVENTIONS)])


def _run(protection: str, intruder: Sequence[str]) -> Outcome:
    """Attack once; the intruder has no certificate."""
    with open_testbed() as testbed, ExitStack() as stack:
        told = testbed.folder / "base.txt"
        told.touch()
        for inside, command in _app(testbed, protection, told):
            stack.enter_context(running(inside, command, signal.SIGINT))
        wait_for_navigation(testbed)
        time.sleep(_SETTLE_S)
        began = time.monotonic_ns()
        with running(testbed, python(*intruder)):
            time.sleep(_ATTACK_S)
        seconds = (time.monotonic_ns() - began) / SECOND
        heard = [turn for at, turn in BaseLog.read(told).messages if at > began]
        share = app_share(heard.count(NAVIGATION), seconds)
        return Outcome(round(_RATE * _ATTACK_S), heard.count(INTRUDER), share)


def _app(testbed: Testbed, protection: str, told: Path) -> Iterator[tuple[Testbed, list[str]]]:
    """Give where each process of the app runs, and its command."""
    plan = intrusion_plan(2, in_cell=protection == "cell")
    path, socket = testbed.folder / "rtron.yaml", testbed.folder / "guard.sock"
    path.write_text(write_plan(plan))
    mode = Protection.ENCRYPT if protection == _ENFORCED else None
    inside = secured(testbed, "keystore", mode, app_access(plan))
    files = ("--plan", str(path), "--control-socket", str(socket))
    yield inside, python("rtron", "guard", *files)
    yield inside, python(PROCESSES, "navigation")
    prefix = cell_command(testbed, plan) if plan.cell else []
    yield inside, [*prefix, *python(PROCESSES, "base", str(told))]
