"""A navigation, a base, and what protects it: nothing, a guard, the master proxy, a cell."""

import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import mkdtemp

from typing_extensions import Self

from bench.cell.celled_route import cell_command
from bench.common.intrusion import DRIVER, NAVIGATION, TOPIC, BaseLog, intrusion_plan
from bench.common.pubsub import PUBLISHER
from bench.common.testbed import Testbed, python, running
from rtron.demos.runtime.isolation import free_port
from rtron.errors import RTronError
from rtron.guard.master_proxy.master_file import find_private_master
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan, flow_topic, output_topic
from rtron.wire.ros1.xmlrpc import ros_call

_SYSTEM_PYTHON = "/usr/bin/python3"
_LIMIT_S = 60.0
_CALL_S = 5.0
_IS_HEARD = 10
"""So many messages of the navigation say that the app drives."""


@dataclass(frozen=True, slots=True)
class Protection:
    """What stands between an intruder and the base: a row of the table."""

    name: str
    guard: bool = False
    fence: bool = False
    cell: bool = False

    @property
    def flow(self) -> str:
        """The topic on which the navigation publishes."""
        return flow_topic(TOPIC, "flow1") if self.guard else TOPIC

    @property
    def out(self) -> str:
        """The topic that the base reads."""
        return output_topic(TOPIC) if self.guard else TOPIC


PROTECTIONS = (
    Protection("none"),
    Protection("guard", guard=True),
    Protection("fence", guard=True, fence=True),
    Protection("cell", guard=True, cell=True),
    Protection("cell_and_fence", guard=True, fence=True, cell=True),
)


class App:
    """The processes of a protected app; the block ends them."""

    def __init__(self, testbed: Testbed, protection: Protection) -> None:
        self.protection = protection
        self.folder = Path(mkdtemp(dir=testbed.folder))
        self.told, self.limits = self.folder / "base.txt", self.folder / "limits.txt"
        environ = {**testbed.environ, "XDG_STATE_HOME": str(self.folder)}
        self._testbed = replace(testbed, environ=environ)
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        """Start everything and wait until the base is driven."""
        self.told.touch()
        try:
            self._start(intrusion_plan(1, in_cell=self.protection.cell))
        except BaseException:
            self._stack.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    @property
    def master(self) -> str:
        """The address that every node knows."""
        return self._testbed.environ["ROS_MASTER_URI"]

    def address_of_base(self) -> str:
        """Return the API of what is called the base; who scans ports needs no master for it."""
        return self._address(DRIVER)

    def ends(self) -> bool:
        """Tell whether the base's process has ended."""
        return self._base.poll() is not None

    def heard(self, turn: float, since: int) -> int:
        """Return how many messages with this turn the base has heard since a time (ns)."""
        return sum(at > since and each == turn for at, each in BaseLog.read(self.told).messages)

    def drives(self, since: int, within_s: float) -> bool:
        """Tell whether the navigation is heard again within so long."""
        deadline = time.monotonic() + within_s
        while self.heard(NAVIGATION, since) < _IS_HEARD and time.monotonic() < deadline:
            time.sleep(0.05)
        return self.heard(NAVIGATION, since) >= _IS_HEARD

    def _start(self, plan: Plan) -> None:
        path = self.folder / "rtron.yaml"
        path.write_text(write_plan(plan))
        if self.protection.fence:
            self._put_proxy(path)
        if self.protection.guard:
            at = str(self.folder / "guard.sock")
            self._run(python("rtron", "guard", "--plan", str(path), "--control-socket", at))
        node = [_SYSTEM_PYTHON, "bench/cell/base.py", str(self.told), str(self.limits)]
        node += [f"__name:={DRIVER[1:]}", f"{TOPIC}:={self.protection.out}"]
        room = replace(self._testbed, folder=self.folder)
        self._base = self._run([*(cell_command(room, plan) if plan.cell else ()), *node])
        nav = [_SYSTEM_PYTHON, "tests/ros1/nodes/nav.py", f"__name:={PUBLISHER[1:]}"]
        self._run([*nav, f"{TOPIC}:={self.protection.flow}"])
        if not self.drives(0, _LIMIT_S):
            raise TimeoutError(f"the app does not start ({self.protection.name})")

    def _run(self, command: list[str]) -> subprocess.Popen[str]:
        return self._stack.enter_context(running(self._testbed, command, signal.SIGINT))

    def _put_proxy(self, plan: Path) -> None:
        port = free_port()
        environ = {**self._testbed.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{port}"}
        self._testbed = replace(self._testbed, environ=environ)
        self._run(python("rtron", "master", "--plan", str(plan), "--port", str(port)))
        wait_until(lambda: ros_call(self.master, "getPid", "/bench", timeout=_CALL_S))

    def _address(self, node: str) -> str:
        master = find_private_master(self.master) if self.protection.fence else self.master
        uri: str = ros_call(master, "lookupNode", "/bench", node, timeout=_CALL_S)
        return uri


def wait_until(condition: Callable[[], object]) -> None:
    """Wait until a call answers; TimeoutError if it does not."""
    deadline = time.monotonic() + _LIMIT_S
    while time.monotonic() < deadline:
        with suppress(RTronError):
            if condition():
                return
        time.sleep(0.05)
    raise TimeoutError("nobody answers")
