"""An app whose nodes, tools and guard come and go: how many false alarms the audit raises.

RTRON_BENCH_CHURN_SECONDS says for how long: 3600 for the hour that the guard must stand.
"""

import random
import signal
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from bench.common.log_watcher import LogWatcher
from bench.common.plans import grcn
from bench.common.testbed import ReportProgress, Testbed, end, python, start
from bench.common.workload import CHURN_SECONDS
from bench.ros1.audit import DRIVERS
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import AlarmKind, Plan, flow_topic

_PAUSE_S = (0.0, 1.5)
_KINDS = tuple(f": {kind}:" for kind in AlarmKind if kind is not AlarmKind.GUARD)
"""The alarms of the audit; those of the supervisor tell of guards that were killed here."""
_NAV = ["rostopic", "pub", "-r", "20", "/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.1}}"]


@dataclass(slots=True)
class AppProcess:
    """A process of the app that is started anew again and again."""

    command: Sequence[str]
    running: list[subprocess.Popen[str]] = field(default_factory=list)

    def restart(self, testbed: Testbed, *, gracefully: bool) -> None:
        """End the process, with a word to the master or without, and start it."""
        for process in self.running:
            end(process, signal.SIGINT if gracefully else signal.SIGKILL)
        self.running = [start(testbed, self.command, piped=False)]

    def close(self) -> None:
        """End the process."""
        for process in self.running:
            end(process, signal.SIGINT)


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give how often something was started anew, and the alarms of the audit meanwhile."""
    with _members(testbed) as members:
        log = LogWatcher(testbed.folder / "errors.log")
        chance, restarts = random.Random(1), 0
        deadline = time.monotonic() + CHURN_SECONDS
        while (left := deadline - time.monotonic()) > 0:
            progress(f"{restarts} restarts, {left:.0f} s to go")
            chance.choice(members).restart(testbed, gracefully=chance.random() < 0.5)
            restarts += 1
            time.sleep(chance.uniform(*_PAUSE_S))
        false = log.count(lambda line: "alarm:" in line and any(k in line for k in _KINDS))
        log.close()
    yield Figure("churn.restarts", restarts, None, f"in {CHURN_SECONDS} s")
    yield Figure("churn.false_alarms", false, None, f"in {CHURN_SECONDS} s", at_most=0)


@contextmanager
def _members(testbed: Testbed) -> Iterator[list[AppProcess]]:
    """Start the guard and the app."""
    names = [f"driver_{library}" for library in DRIVERS]
    node = replace(grcn("/cmd_vel", ["/nav"]), successors=tuple(f"/{name}" for name in names))
    path = testbed.folder / "churn.yaml"
    path.write_text(write_plan(Plan(app="churn", grcn=(node,))), encoding="utf-8")
    guard = AppProcess(python("rtron", "guard", "--plan", str(path), "--log-level", "warning"))
    drivers = [
        AppProcess([*command, f"__name:={name}"])
        for name, command in zip(names, DRIVERS.values(), strict=True)
    ]
    nav = AppProcess([*_NAV, f"/cmd_vel:={flow_topic('/cmd_vel', 'flow1')}", "__name:=nav"])
    tool = AppProcess(["rostopic", "hz", "/cmd_vel"])
    members = [guard, *drivers, nav, tool]
    try:
        for member in members:
            member.restart(testbed, gracefully=True)
        yield members
    finally:
        for member in reversed(members):
            member.close()
