"""A driven base of ROS 2 whose driver runs in a cell: the app outside, and what attacks it."""

import json
import shutil
import sys
import sysconfig
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from celled_base import open_file, open_folder, others_may_run
from harness import wait_for
from ros2_harness import NODES2, Ros2
from ros2_plans import driving, written

NODE = "/driver"
CMD_VEL = "/cmd_vel"
OUT, FLOW1 = "/rtron/cmd_vel/out", "/rtron/cmd_vel/nav"
STOP = ("0.0", "0.0")
PLAN, DRIVEN = "rtron.yaml", "driven.txt"


def python_for_others():
    """Return the command of this Python, or of the system's, for a user who may not enter /root."""
    if others_may_run(sys.executable):
        return (sys.executable,)
    name = f"/usr/bin/python{sys.version_info.major}.{sys.version_info.minor}"
    paths = ":".join({sysconfig.get_path(each) for each in ("purelib", "platlib")})
    return ("env", f"PYTHONPATH={paths}", name)


def copy_base(folder):
    """Put the base's program where every user may read it."""
    return shutil.copy(NODES2 / "base_in_cell2.py", folder / "base.py")


_ALONE = (
    "import os, sys; from rtron.guard.cell.init import raise_loopback; "
    "raise_loopback(); os.execvp(sys.argv[1], sys.argv[1:])"
)
SHARED_MEMORY = {"FASTDDS_BUILTIN_TRANSPORTS": "SHM", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}


def alone(*command):
    """Return a command that has a network of its own, and the machine's /dev/shm."""
    unshare = ("unshare", "--net", "--pid", "--fork", "--kill-child", "--")
    return (*unshare, sys.executable, "-c", _ALONE, *command)


@contextmanager
def ros2_in_open_folder():
    """Have a domain whose processes keep their files where every user may write."""
    with open_folder() as folder, Ros2(folder) as ros2:
        yield ros2


def start_cell2(ros2, *options, arguments=(), environ=None, **manifest):
    """Start the base in a cell; it writes into a file of the folder.

    `manifest` lists what passes, `arguments` are more ROS arguments of the base, and `environ` is
    what the cell is started with.
    """
    (ros2.folder / PLAN).write_text(written(driving("nav"), cell=(NODE,)))
    path = ros2.folder / "cell.json"
    path.write_text(json.dumps({"schema": "rtron.cell/1", "node": NODE, **manifest}))
    program = copy_base(ros2.folder)
    names = ("--ros-args", "-r", "__node:=driver", *arguments)
    command = (*python_for_others(), program, ros2.folder / DRIVEN, OUT, *names)
    words = ("--plan", ros2.folder / PLAN, "--manifest", path, *options, "--", *command)
    return ros2.spawn(sys.executable, "-m", "rtron", "cell", *words, **(environ or {}))


def children(pid):
    """Return the processes that a process has started and that live."""
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(child) for child in text.split()]


def _is_slower(speed, turn, of):
    return 0 <= float(speed) <= float(of) and 0 <= float(turn) < 0.5


class CelledBase2:
    """The driven base: a guard, and a base node in a cell, in a domain; see `start_cell2`."""

    def __init__(self, ros2, *options, **cell):
        self.ros2 = ros2
        self.plan, self._file = ros2.folder / PLAN, open_file(ros2.folder / DRIVEN)
        self.plan.write_text(written(driving("nav"), cell=(NODE,)))
        self.start_guard()
        self._start = partial(start_cell2, ros2, *options, **cell)
        self.restart_cell()

    def start_guard(self):
        self.guard = self.ros2.rtron("guard", "--plan", self.plan)
        wait_for(lambda: "guarding 1 topics" in self.guard.log, what="the guard")

    def restart_cell(self):
        """Start the driver in a cell, and wait until it runs."""
        before = len(self.said("environ"))
        self.cell = self._start()
        wait_for(lambda: len(self.said("environ")) > before or self.cell.ended, what="the driver")
        assert not self.cell.ended, self.cell.log

    def said(self, word):
        """Return what the driver has written that begins with a word, without it."""
        lines = self._file.read_text().splitlines() if self._file.exists() else []
        return [tuple(line.split()[1:]) for line in lines if line.split()[0] == word]

    def messages(self):
        return self.said("drive")

    def navigation(self):
        return [each for each in self.messages() if each[1] == "0.5"]

    def navigate(self, rate="50"):
        """Start navigation and wait until the driver hears it."""
        nav = self.ros2.node("slow_navigation.py", FLOW1, rate, name="/nav")
        wait_for(lambda: len(self.navigation()) > 5, what="navigation at the driver")
        return nav

    def intrude(self, topic, name="/intruder", rate="200", **environ):
        return self.ros2.node("twist_publisher.py", topic, "9", rate, name=name, **environ)

    def intrude_beside(self, topic):
        """Intrude from a network of its own, through the machine's /dev/shm."""
        script = (sys.executable, NODES2 / "twist_publisher.py", topic, "9", "200")
        intruder = self.ros2.spawn(*alone(*script), **SHARED_MEMORY)
        wait_for(lambda: "ready" in intruder.log, what="the intruder")
        return intruder

    def inside(self, *command):
        """Return a command that runs in the network of the cell, which only root may enter."""
        (unshare,) = children(self.cell.pid)
        (init,) = children(unshare)
        return ("nsenter", "--net", f"--target={init}", *command)

    def wait_for_more(self, count=20):
        """Wait until so many more messages of navigation have arrived."""
        end = len(self.navigation()) + count
        wait_for(lambda: len(self.navigation()) >= end, what="more of navigation")

    def assert_undisturbed(self, since=0, more=50):
        """Assert that most of navigation has arrived, in order, and nothing else has.

        Its queue keeps the last ten: who waits for a processor misses some, or is taken for gone,
        so that others slow the robot down.
        """
        self.wait_for_more(more)
        messages = self.messages()[since:]
        first = next(n for n, (_, turn) in enumerate(messages) if turn == "0.5")
        ours = [float(x) for x, turn in messages[first:] if turn == "0.5"]
        others = [each for each in messages[first:] if each[1] != "0.5"]
        assert ours == sorted(set(ours))
        assert len(ours) > 1000 * (ours[-1] - ours[0]) / 2
        assert not [each for each in others if not _is_slower(*each, ours[-1])], others[:5]

    def stands(self):
        return self.messages()[-1] == STOP

    def drives(self):
        return self.messages()[-1][1] == "0.5"
