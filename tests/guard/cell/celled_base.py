"""A driven base of which the driver runs in a cell: the app outside, and what attacks it."""

import json
import os
import shutil
import subprocess
import sysconfig
import tempfile
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from stat import S_IXOTH

import pytest
from driven_base import CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import Ros1, wait_for

import rtron

NODE = "/driver"
OUT, FLOW1 = "/rtron/cmd_vel/out", "/rtron/cmd_vel/flow1"
STOP = ("0", "0")
_NAMESPACES = ["unshare", "--net", "--pid", "--mount", "--ipc", "--fork", "true"]


def _may_be_made():
    """Tell whether this process may make a cell: some containers do not let root."""
    ran = os.getuid() == 0 and subprocess.run(_NAMESPACES, check=False, capture_output=True)
    return bool(ran) and ran.returncode == 0


def others_may_run(program):
    """Tell whether every user may execute a program, or enter a folder."""
    there = Path(program).resolve()
    return all(each.stat().st_mode & S_IXOTH for each in (there, *there.parents))


RTRON = Path(rtron.__file__).parent
needs_cell = pytest.mark.skipif(
    not (_may_be_made() and others_may_run(RTRON)),
    reason="a cell needs root, who may make namespaces, and a user who may enter RTron's folder",
)
needs_open_packages = pytest.mark.skipif(
    not others_may_run(sysconfig.get_path("purelib")),
    reason="the user of a cell may not enter the folder of the Python packages",
)


def is_guarded(log):
    """Tell whether the second stopper hears a guard or a supervisor: a late one it took for gone.

    What it makes of either is tested in test_cell_stopper.py.
    """
    return log.rfind("a guard guards the cell") > log.rfind("nobody guards the cell any more")


def celled_plan(**changes):
    """Return the plan of the driven base with its driver in a cell."""
    return replace(drive_plan(), cell=(NODE,), **changes)


@contextmanager
def open_folder():
    """Make a folder that every user may enter and write."""
    with tempfile.TemporaryDirectory(prefix="rtron-cell-test-") as name:
        folder = Path(name)
        folder.chmod(0o777)
        yield folder


def open_file(path):
    """Make a file that every user may write: a cell may come back with another user."""
    path.touch()
    path.chmod(0o666)
    return path


@contextmanager
def ros1_in_open_folder():
    """Run a master whose processes keep their files where every user may write."""
    with open_folder() as folder, Ros1(folder) as ros1:
        yield ros1


def start_cell(ros1, command, *options, node=NODE, **manifest):
    """Start a node in a cell; `manifest` lists what passes."""
    path = ros1.folder / f"cell{node.replace('/', '_')}.json"
    path.write_text(json.dumps({"schema": "rtron.cell/1", "node": node, **manifest}))
    words = ("--plan", ros1.folder / "rtron.yaml", "--manifest", path)
    return ros1.rtron("cell", *words, *options, "--", *command)


class CelledBase:
    """The driven base: a guard, and a C++ driver in a cell, on a master.

    `ros1` starts processes and answers questions; it may be a view from behind the master proxy.
    """

    def __init__(self, ros1, driver, *options, plan=None, **manifest):
        self.ros1 = ros1
        self.driven = Driven(open_file(ros1.folder / "driven.txt"))
        self.plan = plan or celled_plan()
        self.guard = start_guard(ros1, self.plan, CMD_VEL_GUARD)
        program = shutil.copy(driver, ros1.folder / "driver")
        command = (program, self.driven.path, "__name:=driver", f"/cmd_vel:={OUT}")
        self._start = partial(start_cell, ros1, command, *options, **manifest)
        self.restart_cell()

    def restart_cell(self):
        """Start the driver in a cell, and wait for its gateway."""
        self.cell = self._start()
        wait_for(lambda: self.ros1.has(NODE), what="the gateway of the cell")

    def navigate(self):
        """Start navigation and wait until the driver has its first message."""
        nav = self.ros1.node("nav.py", "/nav", f"/cmd_vel:={FLOW1}")
        wait_for(self.driven.navigation, what="navigation at the driver")
        return nav

    def wait_for_more(self, count=10):
        """Wait until so many more messages of navigation have arrived."""
        end = len(self.driven.navigation()) + count
        wait_for(lambda: len(self.driven.navigation()) >= end, what="more of navigation")

    def assert_undisturbed(self, since=0):
        """Assert that all of navigation has arrived, in order, and nothing else has."""
        self.wait_for_more()
        messages = self.driven.messages()[since:]
        first = next(n for n, (_, turn) in enumerate(messages) if turn == "0.5")
        counts = [round(float(x) * 1000) for x, _ in messages[first:]]
        assert {turn for _, turn in messages[first:]} == {"0.5"}
        assert counts == list(range(counts[0], counts[0] + len(counts)))
