"""A disk that hangs, and the emergency stop that the link process has saved on it."""

import os
import re
import signal

import pytest
from driven_base import CMD_VEL, CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import NODES, ROS_PYTHON, lives, wait_for

from rtron.guard.link.settings_file import write_settings
from rtron.guard.system.machine_time import machine_time
from rtron.vocabulary import EmergencyStop, Settings

pytestmark = pytest.mark.ros1
STOPPED = "emergency stop by ann"
LONG = 25
"""Messages of navigation, 10 a second, in more time than a guard may hang before it is killed."""


class SavingBase:
    """A driven base; the test saves settings as the link process does, whose service is away."""

    def __init__(self, ros1):
        self.ros1 = ros1
        self.driven = Driven(ros1.folder / "driven.txt")
        self.state = ros1.folder / "state"
        token = ros1.folder / "token"
        token.write_text("secret")
        words = ("--service", "http://127.0.0.1:9", "--token-file", token, "--robot", "r1")
        words = (*words, "--state-dir", self.state)
        self.guard = start_guard(ros1, drive_plan(), CMD_VEL_GUARD, *words)
        driver = [ROS_PYTHON, NODES / "driver.py", self.driven.path, "__name:=driver"]
        ros1.spawn(*driver, f"{CMD_VEL}:=/rtron{CMD_VEL}/out")
        ros1.node("nav.py", "/nav", f"{CMD_VEL}:=/rtron{CMD_VEL}/flow1")
        self.wait_for_navigation()

    @property
    def guard_process(self):
        return self.ros1.ask(self.ros1.uri_of(CMD_VEL_GUARD), "getPid")

    def wait_for_navigation(self, count=1):
        end = len(self.driven.navigation()) + count
        wait_for(lambda: len(self.driven.navigation()) >= end, what="navigation at the driver")

    def save_stop(self):
        stop = EmergencyStop(by="ann", reason="a child", at=0)
        write_settings(
            self.state / "settings.json", Settings(revision=2, stop=stop), machine_time()
        )

    def wait_for_stop(self):
        wait_for(lambda: STOPPED in self.guard.log, what="the emergency stop")
        wait_for(lambda: ("0", "0") in self.driven.messages(), what="the stop at the driver")


@pytest.fixture
def base(ros1):
    return SavingBase(ros1)


def test_commands_pass_while_the_disk_hangs(base):
    """Who opens a named pipe waits for its writer."""
    pipe, guard = (
        base.ros1.folder / "pipe",
        base.ros1.ask(base.ros1.uri_of(CMD_VEL_GUARD), "getPid"),
    )
    os.mkfifo(pipe)
    os.link(pipe, base.state / "settings.json")
    base.wait_for_navigation(LONG)
    base.save_stop()
    pipe.write_bytes(b"")
    base.wait_for_stop()
    assert base.guard_process == guard


@pytest.mark.long
def test_a_saved_stop_needs_neither_the_bulk_process_nor_the_link_process(base):
    bulk = int(re.findall(r"the bulk process is there, process (\d+)", base.guard.log)[-1])
    os.kill(bulk, signal.SIGSTOP)
    base.save_stop()
    base.wait_for_stop()
    wait_for(lambda: not lives(bulk), what="the end of the bulk process")
