"""The app that is soaked: a guard, a base, its navigation, a camera, and who must not drive."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import mkdtemp

from bench.common.log_watcher import LogWatcher
from bench.common.plans import grcn
from bench.common.testbed import Testbed, end, python, start
from bench.soak.node import COMMANDS, IMAGE, IMAGES
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Audit, OnForeign, Plan, StreamKind

_SYSTEM_PYTHON = "/usr/bin/python3"
_START_S = 60.0
_GUARD = "the guard begins, process "
PROGRAMS = ("guard", "bulk", "supervisor")
"""The processes of the guard, as the module of each is called."""


class SoakedApp:
    """Processes by role; each can be ended and started again."""

    def __init__(self, testbed: Testbed, ros: int) -> None:
        files = [testbed.folder / name for name in ("base.txt", "pictures.txt", "errors.log")]
        for file in files:
            file.touch()
        self.told, self.seen, errors = files
        self.log = LogWatcher(errors)
        self._testbed = testbed
        self._ros = ros
        self._plan = testbed.folder / "soak.yaml"
        self._plan.write_text(write_plan(_plan(ros)), encoding="utf-8")
        self._socket = Path(mkdtemp(dir=testbed.folder)) / "guard.sock"
        self._running: dict[str, subprocess.Popen[str]] = {}

    def is_running(self, role: str) -> bool:
        """Tell whether a role has a process."""
        return role in self._running

    def start(self, role: str) -> None:
        """Start a role's process."""
        self._running[role] = start(self._testbed, self._command(role), piped=False)

    def end(self, role: str, number: signal.Signals = signal.SIGINT) -> None:
        """End a role's process."""
        end(self._running.pop(role), number)

    def close(self) -> None:
        """End everything, the guard last."""
        for role in [*sorted(self._running.keys() - {"guard"}), "guard"]:
            if self.is_running(role):
                self.end(role)
        for program in PROGRAMS:
            for pid in self.pids(program):
                self.send(pid, signal.SIGKILL)
        self.log.close()

    def picture_count(self) -> int:
        """Return how many pictures came through the guard."""
        return len(self.seen.read_text("utf-8").splitlines())

    def guard(self) -> int:
        """Return the process that guards, not the one that waits to."""
        begun = [text for _, text in list(self.log.lines) if _GUARD in text]
        return int(begun[-1].rpartition(_GUARD)[2].split()[0])

    def pids(self, program: str) -> list[int]:
        """Return the processes of one of the guard's programs."""
        return [pid for pid in _all_pids() if self._is_ours(pid, f"rtron-{program}_program")]

    def send(self, pid: int, number: signal.Signals) -> None:
        """Send a signal to a process, if it is there."""
        with suppress(ProcessLookupError):
            os.kill(pid, number)

    def clear(self) -> bool:
        """Let the robot drive again after an intrusion; tell whether the guard does."""
        arguments = ("clear", "--plan", self._plan, "--control-socket", self._socket)
        command = python("rtron", *map(str, arguments), "--reason", "soak")
        run = subprocess.run(
            command, env=self._testbed.environ, capture_output=True, text=True, check=False
        )
        return run.returncode == 0 or "no intruder" in run.stderr

    def _is_ours(self, pid: int, word: str) -> bool:
        folder = Path("/proc", str(pid))
        try:
            command, environ = (folder / "cmdline").read_bytes(), (folder / "environ").read_bytes()
        except OSError:
            return False
        return word.encode() in command and str(self._testbed.folder).encode() in environ

    def _command(self, role: str) -> list[str]:
        if role == "guard":
            arguments = ("guard", "--plan", self._plan, "--control-socket", self._socket)
            return python("rtron", *map(str, arguments))
        interpreter = _SYSTEM_PYTHON if self._ros == 1 else sys.executable
        files = {"base": [str(self.told)], "viewer": [str(self.seen)]}.get(role, [])
        return [interpreter, "-m", "bench.soak.node", str(self._ros), role, *files]


def _all_pids() -> Iterator[int]:
    return (int(each.name) for each in Path("/proc").iterdir() if each.name.isdigit())


def _plan(ros: int) -> Plan:
    commands = replace(grcn(COMMANDS, ["/nav"]), successors=("/base",))
    images = replace(
        grcn(IMAGES, ["/camera"], IMAGE), kind=StreamKind.STATE, successors=("/viewer",)
    )
    audit = Audit(on_foreign=OnForeign.STOP)
    return Plan(app="soak", ros=ros, grcn=(commands, images), audit=audit)


@contextmanager
def running_app(testbed: Testbed, ros: int) -> Iterator[SoakedApp]:
    """Run the app until the end of the block; all of it is there when the block begins."""
    app = SoakedApp(testbed, ros)
    try:
        app.start("guard")
        app.log.wait("its delivery is watched", 0, _START_S)
        for role in ("base", "viewer", "nav", "rogue"):
            app.start(role)
        yield app
    finally:
        app.close()
