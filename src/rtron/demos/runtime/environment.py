"""A run's surroundings: the world, a ROS of our own, and the files that the nodes are told of."""

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import getnode

from rtron.demos.runtime.app_files import APPS, other_packages
from rtron.demos.runtime.app_launch import App, launched
from rtron.demos.runtime.environ import ros1_environ, ros2_environ, shared_environ
from rtron.demos.runtime.isolation import free_port, own_domain
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Finished, Processes, Started
from rtron.demos.runtime.ros_installation import need
from rtron.demos.runtime.rosmaster import running_master
from rtron.demos.runtime.world import running_world
from rtron.demos.world.client import Owner

BY_HAND = "safe_control_by_hand"
_MAC_BYTES = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class Begun:
    """What the runs of a demo share: a ROS (1 or 2), the world at a speed, and a folder.

    `python` runs RTron beside that ROS, `environ` leads there. `trigger`, `journal` and `map` are
    what DEMO_TRIGGER, DEMO_JOURNAL and DEMO_MAP name.
    """

    ros: int
    folder: Path
    speed: float
    python: Path
    environ: Mapping[str, str]
    processes: Processes
    owner: Owner

    @property
    def trigger(self) -> Path:
        """The file that tells the malicious nodes when to attack."""
        return self.folder / "trigger.json"

    @property
    def journal(self) -> Path:
        """The folder with what the nodes sent and received."""
        return self.folder / "journal"

    @property
    def map(self) -> Path:
        """The file with the static map."""
        return self.folder / "map.json"

    def arm(
        self, attack: str, run: int, after: float = 0.0, goal: Sequence[float] | None = None
    ) -> None:
        """Tell the malicious nodes to attack in a run, `after` simulated seconds of movement.

        `attack` is gr, rsr, msr or none. The MAC address is this machine's.
        """
        mac = getnode().to_bytes(_MAC_BYTES, "big").hex(":")
        order = {"mac": mac, "attack": attack, "after": after, "run": run}
        _put(self.trigger, {**order, "goal": None if goal is None else list(goal)})

    def show_map(self, scene: Mapping[str, Any]) -> None:
        """Give the navigation the walls and obstacles of a scene."""
        _put(self.map, scene)

    def rtron(self, *words: str | Path, codes: Sequence[int] = (0,)) -> Finished:
        """Run a command of RTron; SourceError if it ends with none of the exit codes."""
        with self.rtron_beside(*words, codes=codes) as finished:
            typed = " ".join(map(_typed, words))
            return replace(finished(), command=f"rtron {typed}")

    def rtron_beside(
        self, *words: str | Path, codes: Sequence[int] = (0,)
    ) -> AbstractContextManager[Callable[[], Finished]]:
        """Run a command of RTron beside the block, which waits for its end."""
        command = [self.python, "-m", "rtron", *words]
        return self.processes.finishing(command, self.environ, codes, name=str(words[0]))

    def launched(
        self, launch: Path, more: Mapping[str, str] | None = None, plan: Path | None = None
    ) -> AbstractContextManager[App]:
        """Run the app of a launch file until the end of the block; the nodes are joined then.

        `more` is for the environment; with `plan` every path of that plan is closed, too. Whatever
        was armed is disarmed.
        """
        self.arm("none", 0)
        return launched(self, launch, more or {}, plan)

    @contextmanager
    def by_hand(self, name: str = BY_HAND) -> Iterator[Started]:
        """Run the malicious node of tb3_safe_control by hand, under another node name."""
        script = other_packages(self.ros) / "tb3_safe_control" / "scripts" / "tb3_safe_control"
        renamed: list[str | Path] = [script, f"__name:={name}"]
        if self.ros != 1:
            renamed = [self.python, script, "--ros-args", "-r", f"__node:={name}"]
        journal = self.journal / f"{name}.jsonl"
        journal.unlink(missing_ok=True)
        with self.processes.running(renamed, self.environ, name=name) as started:
            wait_for(lambda: _is_there(started, journal), name)
            yield started


@contextmanager
def begun(ros: int, folder: Path, *, speed: float = 1.0) -> Iterator[Begun]:
    """Begin a demo on ROS 1 or 2, all its files in a new `folder`; all ends with the block.

    SourceError if that ROS is not there. To be entered in the main thread.
    """
    python, folder = need(ros), folder.absolute()
    for made in (folder, folder / "log", folder / "journal"):
        made.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        sockets = Path(stack.enter_context(TemporaryDirectory(prefix="rtron-demo-")))
        processes = stack.enter_context(Processes(folder / "log"))
        world = sockets / "world"
        environ = shared_environ(folder, sockets) | {"DEMO_WORLD": str(world)}
        owner = stack.enter_context(running_world(processes, world, speed, environ))
        environ |= _named(folder, speed) | _joined(stack, ros, processes, environ)
        begun = Begun(
            ros=ros,
            folder=folder,
            speed=speed,
            python=python,
            environ=environ,
            processes=processes,
            owner=owner,
        )
        begun.arm("none", 0)
        yield begun


def _typed(word: str | Path) -> str:
    """Return a word of a command as one would type it beside the demo's packages."""
    if isinstance(word, str):
        return word
    return str(word.relative_to(APPS)) if word.is_relative_to(APPS) else word.name


def _named(folder: Path, speed: float) -> dict[str, str]:
    return {
        "DEMO_JOURNAL": str(folder / "journal"),
        "DEMO_MAP": str(folder / "map.json"),
        "DEMO_SPEED": f"{speed:g}",
        "DEMO_TRIGGER": str(folder / "trigger.json"),
    }


def _joined(
    stack: ExitStack, ros: int, processes: Processes, environ: Mapping[str, str]
) -> dict[str, str]:
    """Return what leads to a ROS of our own, which is there until the stack ends."""
    if ros != 1:
        return ros2_environ(stack.enter_context(own_domain()))
    found = ros1_environ(free_port())
    stack.enter_context(running_master(processes, {**environ, **found}))
    return found


def _is_there(started: Started, journal: Path) -> bool:
    started.check()
    return journal.exists()


def _put(path: Path, value: Mapping[str, Any]) -> None:
    """Write JSON whole or not at all, for readers that may come any time."""
    whole = path.with_suffix(".new")
    whole.write_text(json.dumps(value), encoding="utf-8")
    os.replace(whole, path)  # noqa: PTH105 - says that what is there is replaced
