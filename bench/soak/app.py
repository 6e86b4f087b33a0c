"""The app that is soaked: a guard, a base, its navigation, a camera, and who must not drive."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import mkdtemp

from bench.common.log_watcher import LogWatcher
from bench.common.testbed import Testbed, end, python, start
from bench.soak.base_log import BaseLog
from bench.soak.names import DOCK, IMAGE_RATES
from bench.soak.plan import soak_plan
from rtron.vocabulary import (
    ROS1_CLIENT_TOPICS,
    ROS1_SERVER_TOPICS,
    Ros2ActionEntity,
    flow_topic,
    output_topic,
    ros1_topic_name,
    ros2_entity_name,
)
from rtron.vocabulary.action import SERVER_FLOW

_SYSTEM_PYTHON = "/usr/bin/python3"
_START_S = 60.0
_GUARD = "the guard begins, process "
_FLOW = "flow1"
_RECENT_BYTES = 5000
PROGRAMS = ("guard", "bulk", "supervisor")
"""The processes of the guard."""
_NAME_LENGTH = 15
"""Of a process (proc(5), comm)."""
_WRITERS = ("base", "viewer", "camera", "detector", "dock", "planner")
_OTHERS = ("base", "viewer", "dock", "planner", "detector", "nav", "joystick", "rogue")


class SoakedApp:
    """Processes by role; each can be ended and started again."""

    def __init__(self, testbed: Testbed, ros: int, stall_after: str = "") -> None:
        self.files = {role: testbed.folder / f"{role}.txt" for role in _WRITERS}
        errors = testbed.folder / "errors.log"
        for file in (*self.files.values(), errors):
            file.touch()
        self.log = LogWatcher(errors)
        self._testbed = testbed
        self._ros = ros
        self._plan = testbed.folder / "soak.yaml"
        self._plan.write_text(soak_plan(ros, stall_after), encoding="utf-8")
        self._socket = Path(mkdtemp(dir=testbed.folder)) / "guard.sock"
        self._running: dict[str, subprocess.Popen[str]] = {}

    def is_running(self, role: str) -> bool:
        """Tell whether a role has a process."""
        return role in self._running

    def ended(self) -> list[str]:
        """Return who has ended for good although nobody ended it: the app's roles, and programs.

        A program is gone when it has no process at all.
        """
        app = (each for each in self._running.items() if each[0] != "guard")
        roles = [role for role, process in app if process.poll() is not None]
        return roles + [program for program in PROGRAMS if not self.pids(program)]

    def start(self, role: str, *arguments: str) -> None:
        """Start a role's process."""
        command = self._guard_command() if role == "guard" else self._command(role, arguments)
        self._running[role] = start(self._testbed, command, piped=False)

    def film(self, rate: int = IMAGE_RATES[0]) -> None:
        """Start the camera, pictures a second."""
        self.start("camera", str(rate))

    def end(self, role: str, number: signal.Signals = signal.SIGINT) -> None:
        """End a role's process."""
        end(self._running.pop(role), number)

    def send_to(self, role: str, number: signal.Signals) -> None:
        """Send a signal to a role's process."""
        self._running[role].send_signal(number)

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
        return len(self.files["viewer"].read_text("utf-8").splitlines())

    def guard(self) -> int:
        """Return the process that guards, not the one that waits to."""
        begun = next(text for _, text in reversed(self.log.lines) if _GUARD in text)
        return int(begun.rpartition(_GUARD)[2].split()[0])

    def pids(self, program: str) -> list[int]:
        """Return the processes of one of the guard's programs."""
        name = f"rtron-{program}"[:_NAME_LENGTH]
        return [pid for pid in _all_pids() if self._is_ours(pid, name)]

    def send(self, pid: int, number: signal.Signals) -> None:
        """Send a signal to a process, if it is there."""
        with suppress(ProcessLookupError):
            os.kill(pid, number)

    def is_driving(self) -> bool:
        """Tell whether the base moves."""
        base = BaseLog.read(self.files["base"], last=_RECENT_BYTES)
        return any(each.speed for each in base.outputs)

    def has_heard_intruder(self, since: int) -> bool:
        """Tell whether the base has heard who goes past the guard since a time, ns."""
        base = BaseLog.read(self.files["base"], last=_RECENT_BYTES)
        return any(each.is_intruders and each.at > since for each in base.outputs)

    def clear(self) -> bool:
        """Let the robot drive again after an intrusion; tell whether the guard does."""
        arguments = ("clear", "--plan", self._plan, "--control-socket", self._socket)
        command = python("rtron", *map(str, arguments), "--reason", "soak")
        run = subprocess.run(
            command, env=self._testbed.environ, capture_output=True, text=True, check=False
        )
        return run.returncode == 0 or "no intruder" in run.stderr

    def _is_ours(self, pid: int, name: str) -> bool:
        folder = Path("/proc", str(pid))
        try:
            found, environ = (folder / "comm").read_text(), (folder / "environ").read_bytes()
        except OSError:
            return False
        return found.strip() == name and str(self._testbed.folder).encode() in environ

    def _guard_command(self) -> list[str]:
        arguments = ("guard", "--plan", self._plan, "--control-socket", self._socket)
        return python("rtron", *map(str, arguments))

    def _command(self, role: str, arguments: Sequence[str]) -> list[str]:
        interpreter = _SYSTEM_PYTHON if self._ros == 1 else sys.executable
        file = [str(self.files[role])] if role in self.files else []
        remaps = list(_REMAPS[self._ros](role))
        module = ["-m", "bench.soak.node", str(self._ros), role]
        return [interpreter, *module, *file, *arguments, *remaps]


def _all_pids() -> Iterator[int]:
    return (int(each.name) for each in Path("/proc").iterdir() if each.name.isdigit())


def _ros1_remaps(role: str) -> Iterator[str]:
    """Yield the remaps of the action's ends, as a guarded launch has them."""
    if role not in ("planner", "dock"):
        return
    client_flow, server_flow = (_FLOW, "out") if role == "planner" else ("out", SERVER_FLOW)
    for parts, flow in ((ROS1_CLIENT_TOPICS, client_flow), (ROS1_SERVER_TOPICS, server_flow)):
        for part in parts:
            topic = ros1_topic_name(DOCK, part)
            yield f"{topic}:={flow_topic(topic, flow)}"


def _ros2_remaps(role: str) -> Iterator[str]:
    """Yield the remaps of the action's ends, as a guarded launch has them."""
    if role not in ("planner", "dock"):
        return
    private = flow_topic(DOCK, _FLOW) if role == "planner" else output_topic(DOCK)
    yield "--ros-args"
    for entity in Ros2ActionEntity:
        yield from ("-r", f"{ros2_entity_name(DOCK, entity)}:={ros2_entity_name(private, entity)}")


_REMAPS = {1: _ros1_remaps, 2: _ros2_remaps}


@contextmanager
def running_app(testbed: Testbed, ros: int, stall_after: str = "") -> Iterator[SoakedApp]:
    """Run the app without a camera until the end of the block; all of it has been started."""
    app = SoakedApp(testbed, ros, stall_after)
    try:
        app.start("guard")
        app.log.wait("its delivery is watched", 0, _START_S)
        for role in _OTHERS:
            app.start(role)
        yield app
    finally:
        app.close()
