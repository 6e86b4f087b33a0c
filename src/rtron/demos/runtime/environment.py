"""A run's surroundings: the world, a ROS of our own, and the files that the nodes are told of."""

import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import getnode

from rtron.demos.runtime.isolation import (
    APPS,
    free_port,
    reserve_domain,
    ros1_environ,
    ros2_environ,
    shared_environ,
    third_party_packages,
)
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Command, CompletedCommand, ProcessGroup, StartedProcess
from rtron.demos.runtime.ros_installation import find_ros_python
from rtron.demos.world.client import WorldClient
from rtron.demos.world.scenes.geometry import clearance_map
from rtron.demos.world.scenes.scene import Scene
from rtron.errors import SourceError
from rtron.workflows.live_app import master_answers

_NAME = "/rtron_demo"
_ANSWER_TIMEOUT_S = 2.0
_ATTEMPTS, _BEGIN_TIMEOUT_S = 3, 40.0
_LONGEST_FOLDER = 107 - len("/rtron-approvals_tb3_demo.sock")
"""The longest name of a folder for sockets, bytes."""


@contextmanager
def run_master(processes: ProcessGroup, environ: Mapping[str, str]) -> Iterator[None]:
    """Run a master at ROS_MASTER_URI of `environ` until the end of the block."""
    uri = environ["ROS_MASTER_URI"]
    command = ["rosmaster", "--core", "-p", uri.rpartition(":")[2]]
    with processes.running(command, environ):
        wait_for(lambda: master_answers(uri, _NAME, _ANSWER_TIMEOUT_S), "the ROS master")
        yield


MANUAL_ATTACKER = "safe_control_by_hand"
_MAC_BYTES = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoEnvironment:
    """What the runs of a demo share: a ROS (1 or 2), the world at a speed, and a folder.

    `python` runs RTron beside that ROS, `environ` leads there. `trigger`, `journal`, `teleop`
    and `map` are what DEMO_TRIGGER, DEMO_JOURNAL, DEMO_TELEOP and DEMO_MAP name.
    """

    ros: int
    folder: Path
    speed: float
    python: Path
    environ: Mapping[str, str]
    processes: ProcessGroup
    owner: WorldClient

    @property
    def trigger(self) -> Path:
        """The file that tells the malicious nodes when to attack."""
        return self.folder / "trigger.json"

    @property
    def journal(self) -> Path:
        """The folder with what the nodes sent and received."""
        return self.folder / "journal"

    @property
    def state(self) -> Path:
        """The folder with what guards keep."""
        return self.folder / "state"

    @property
    def teleop(self) -> Path:
        """The file with the command of a person who drives."""
        return self.folder / "teleop.txt"

    @property
    def map(self) -> Path:
        """The file with the static map."""
        return self.folder / "map.json"

    def arm_attack(
        self, attack: str, run: int, after: float = 0.0, goal: Sequence[float] | None = None
    ) -> None:
        """Tell the malicious nodes to attack in a run, `after` simulated seconds of movement.

        `attack` is gr, rsr, msr, agent or none. The MAC address is this machine's.
        """
        mac = getnode().to_bytes(_MAC_BYTES, "big").hex(":")
        order = {"mac": mac, "attack": attack, "after": after, "run": run}
        _write_json(self.trigger, {**order, "goal": None if goal is None else list(goal)})

    def write_map(self, scene: Scene) -> None:
        """Give the navigation the static map of a scene."""
        _write_json(self.map, clearance_map(scene))

    def run_rtron(self, *arguments: str | Path, codes: Sequence[int] = (0,)) -> CompletedCommand:
        """Run a command of RTron; SourceError if it ends with none of the exit codes."""
        command = [self.python, "-m", "rtron", *arguments]
        done = self.processes.run_command(command, self.environ, codes, name=str(arguments[0]))
        return replace(done, command=" ".join(["rtron", *map(_display_argument, arguments)]))

    def third_party_command(self, package: str, script: str, *arguments: str) -> Command:
        """Return what starts a script of a third-party package."""
        path = third_party_packages(self.ros) / package / "scripts" / script
        return [path, *arguments] if self.ros == 1 else [self.python, path, *arguments]

    @contextmanager
    def run_attacker(
        self, name: str, command: Command, environ: Mapping[str, str]
    ) -> Iterator[None]:
        """Run an attacker that is not of the app until the end of the block.

        It is begun again if it hears nothing: Fast DDS 3.2 may never give a node an endpoint.
        """
        journal = self.journal / f"{name}.jsonl"
        for _ in range(_ATTEMPTS):
            journal.unlink(missing_ok=True)
            with self.processes.running(command, environ, name=name) as started:
                if _begins_journal(started, journal):
                    yield
                    return
        raise SourceError(f"{name} hears nothing of the robot")

    def run_manual_attacker(self) -> AbstractContextManager[None]:
        """Run the malicious node of tb3_safe_control by hand, under another node name."""
        renamed = {1: [f"__name:={MANUAL_ATTACKER}"]}
        renamed[2] = ["--ros-args", "-r", f"__node:={MANUAL_ATTACKER}"]
        script = "tb3_safe_control"
        command = self.third_party_command(script, script, *renamed[self.ros])
        return self.run_attacker(MANUAL_ATTACKER, command, self.environ)


@contextmanager
def demo_environment(ros: int, folder: Path, *, speed: float = 1.0) -> Iterator[DemoEnvironment]:
    """Begin a demo on ROS 1 or 2, all its files in a new `folder`; all ends with the block.

    SourceError if that ROS is not there. To be entered in the main thread.
    """
    python, folder = find_ros_python(ros), folder.absolute()
    for new_folder in (folder, folder / "log", folder / "journal"):
        new_folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        sockets = Path(stack.enter_context(TemporaryDirectory(prefix="rtron-demo-")))
        _check_length(sockets)
        processes = stack.enter_context(ProcessGroup(folder / "log"))
        world = sockets / "world"
        environ = shared_environ(folder, sockets) | {"DEMO_WORLD": str(world)}
        owner = stack.enter_context(run_world(processes, world, speed, environ))
        environ |= _node_environ(folder, speed) | _ros_environ(stack, ros, processes, environ)
        environment = DemoEnvironment(
            ros=ros,
            folder=folder,
            speed=speed,
            python=python,
            environ=environ,
            processes=processes,
            owner=owner,
        )
        environment.arm_attack("none", 0)
        yield environment


def _check_length(sockets: Path) -> None:
    """Raise SourceError if a folder's name leaves no room for those of sockets (unix(7))."""
    if len(os.fsencode(sockets)) > _LONGEST_FOLDER:
        help = f"set TMPDIR to another folder, such as /tmp: {sockets.parent} is too long"
        raise SourceError("no Unix socket can be made below TMPDIR", help=help)


def _display_argument(argument: str | Path) -> str:
    """Return a word of a command as one would type it beside the demo's packages."""
    if isinstance(argument, str):
        return argument
    return str(argument.relative_to(APPS)) if argument.is_relative_to(APPS) else argument.name


def _node_environ(folder: Path, speed: float) -> dict[str, str]:
    return {
        "DEMO_JOURNAL": str(folder / "journal"),
        "DEMO_MAP": str(folder / "map.json"),
        "DEMO_SPEED": f"{speed:g}",
        "DEMO_TELEOP": str(folder / "teleop.txt"),
        "DEMO_TRIGGER": str(folder / "trigger.json"),
    }


def _ros_environ(
    stack: ExitStack, ros: int, processes: ProcessGroup, environ: Mapping[str, str]
) -> dict[str, str]:
    """Return what leads to a ROS of our own, which is there until the stack ends."""
    if ros != 1:
        return ros2_environ(stack.enter_context(reserve_domain()))
    found = ros1_environ(free_port())
    stack.enter_context(run_master(processes, {**environ, **found}))
    return found


def _begins_journal(started: StartedProcess, journal: Path) -> bool:
    """Wait until a node begins its journal; tell whether it has. SourceError if it has ended."""

    def has_begun() -> bool:
        started.check()
        return journal.exists()

    with suppress(SourceError):
        return wait_for(has_begun, journal.stem, _BEGIN_TIMEOUT_S)
    started.check()
    return False


def _write_json(path: Path, value: Mapping[str, Any]) -> None:
    """Write JSON whole or not at all, for readers that may come any time."""
    temporary = path.with_suffix(".new")
    temporary.write_text(json.dumps(value), encoding="utf-8")
    os.replace(temporary, path)  # noqa: PTH105 - says that what is there is replaced


@contextmanager
def run_world(
    processes: ProcessGroup, socket: Path, speed: float, environ: Mapping[str, str]
) -> Iterator[WorldClient]:
    """Run a world of simulated seconds a second `speed`, in the caller's Python; give its owner.

    SourceError if it does not come up, with what it said.
    """
    command: Command = [sys.executable, "-m", "rtron.demos.world", socket, str(speed)]
    with (
        processes.running(command, environ, name="world") as world,
        closing(wait_for(lambda: _become_owner(world, socket), "the world")) as owner,
    ):
        yield owner


def _become_owner(world: StartedProcess, socket: Path) -> WorldClient | None:
    world.check()
    return WorldClient.connect(socket)
