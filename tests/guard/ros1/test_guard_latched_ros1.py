"""What a publisher has latched before the guard listened moves nothing, nor after a guard's end."""

import os
import re
import signal

import pytest
from driven_base import CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import wait_for
from rostopic import TWIST

from rtron.vocabulary import flow_topic

pytestmark = pytest.mark.ros1
OLD, NEW = 0.5, 0.25


def test_a_latched_command_from_before_the_guard_moves_nothing(ros1):
    driven = Driven(ros1.folder / "driven.txt")
    ros1.node("driver.py", "/driver", driven.path, "/cmd_vel:=/rtron/cmd_vel/out")
    latched(ros1, OLD)
    guard = start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
    wait_for(lambda: guard.log.count("sent before the guard listened") == 1, what="the old command")
    os.kill(int(re.findall(r"the guard begins, process (\d+)", guard.log)[-1]), signal.SIGKILL)
    wait_for(lambda: guard.log.count("sent before the guard listened") == 2, what="it once more")
    latched(ros1, NEW)
    wait_for(lambda: NEW in speeds(driven), what="a command that was latched since")
    assert OLD not in speeds(driven)


def latched(ros1, speed):
    """Start a planned publisher that latches its one command, and wait until it has sent it."""
    topic = flow_topic("/cmd_vel", "flow1")
    words = ("rostopic", "pub", topic, "geometry_msgs/Twist", TWIST % speed, "__name:=nav")
    publisher = ros1.spawn(*words)
    wait_for(lambda: "latching" in publisher.log, what="the latched command")


def speeds(driven):
    return {float(speed) for speed, _ in driven.messages()}
