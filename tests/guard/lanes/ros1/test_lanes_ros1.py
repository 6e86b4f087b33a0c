"""The processes of the guard between real nodes: frames and events in one, commands in another."""

import os
import re
import signal
import time

import pytest
from driven_base import Driven, start_guard
from harness import lives, wait_for
from rostopic import IMAGE, TWIST, say
from traffic_light import RED, Light

from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    PolicyName,
    StopProfile,
)

pytestmark = pytest.mark.ros1
SPEED = 0.8
MOVING = GuardedTopic(
    topic="/cmd_vel",
    type="geometry_msgs/Twist",
    flows=(Flow(name="flow1", publisher="/nav", silent_after=3 * SECOND),),
    successors=("/driver",),
)
SAFE = RSRCN(
    id="rsrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.SAFE,
    vflows=(MOVING,),
    threshold=0.1,
    max_accel_limit=5.0,
)
DETECTOR = FpsMonitor(id="fps_detector", node="/detector", topic="/detector/image")
LIGHT = MSRCN(
    id="msrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.BLOCK,
    aflows=(MOVING,),
    eflows=(RED,),
    rules=(MissionRule(name="light", when="red", block=("/cmd_vel",)),),
)


class LanedBase:
    """A driver behind the guard; navigation drives at full speed."""

    def __init__(self, ros1, driver, node, **plan):
        self.driven = Driven(ros1.folder / "driven.txt")
        ros1.spawn(driver, self.driven.path, "__name:=driver", "/cmd_vel:=/rtron/cmd_vel/out")
        ros1.wait_for_nodes("/driver")
        self.guard = start_guard(ros1, Plan(app="base", stop=StopProfile(), **plan), node)
        self._ros1, self._node = ros1, node

    def navigate(self):
        remap = "/cmd_vel:=/rtron/cmd_vel/flow1"
        say(self._ros1, "nav", "/cmd_vel", "geometry_msgs/Twist", TWIST % SPEED, 20, remap)
        self.wait_for_speed(SPEED, "navigation")

    def wait_for_speed(self, speed, what, since=0):
        wait_for(lambda: speed in self.speeds()[since:], what=what)

    def speeds(self):
        return [round(float(x), 3) for x, _ in self.driven.messages()]

    @property
    def bulk_process(self):
        return int(re.findall(r"the bulk process is there, process (\d+)", self.guard.log)[-1])

    @property
    def command_process(self):
        return self._ros1.ask(self._ros1.uri_of(self._node), "getPid")


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_without_the_process_that_counts_frames_the_robot_rests(ros1, driver, number):
    base = LanedBase(ros1, driver, "/rtron/rsrcn", rsrcn=SAFE, fps_monitor=(DETECTOR,))
    say(ros1, "detector", "/detector/image", "sensor_msgs/Image", IMAGE, 20)
    base.navigate()
    bulk, command, before = base.bulk_process, base.command_process, len(base.speeds())
    os.kill(bulk, number)
    base.wait_for_speed(0.0, "rest", before)
    wait_for(lambda: not lives(bulk), what="the end of the bulk process")
    wait_for(lambda: base.bulk_process != bulk, what="the next bulk process")
    base.wait_for_speed(SPEED, "navigation again", len(base.speeds()))
    assert base.command_process == command
    assert max(base.speeds()) == SPEED


def freeze(process, duration_s):
    """Leave a process without the processor for a while."""
    os.kill(process, signal.SIGSTOP)
    until = time.monotonic() + duration_s
    wait_for(lambda: time.monotonic() > until, what="the end of the freeze")
    os.kill(process, signal.SIGCONT)


@pytest.mark.long
def test_a_bulk_process_that_is_late_again_and_again_is_not_killed(ros1, driver):
    """The last time it is away for longer than one that was never late may be."""
    base = LanedBase(ros1, driver, "/rtron/msrcn", msrcn=LIGHT)
    light = Light(ros1, "green")
    base.navigate()
    bulk, command = base.bulk_process, base.command_process
    for duration_s in (0.7, 0.7, 0.7, 2.2):
        freeze(bulk, duration_s)
        before = len(base.speeds())
        base.wait_for_speed(SPEED, "navigation, which needs the next numbers", before)
    before = len(base.speeds())
    light.turn("red")
    base.wait_for_speed(0.0, "rest at the red light", before)
    assert (base.bulk_process, base.command_process) == (bulk, command)
    assert lives(bulk)
    assert "stands still" not in base.guard.log


def test_without_the_process_that_reads_events_a_rule_blocks(ros1, driver):
    base = LanedBase(ros1, driver, "/rtron/msrcn", msrcn=LIGHT)
    light = Light(ros1, "green")
    base.navigate()
    bulk, before = base.bulk_process, len(base.speeds())
    os.kill(bulk, signal.SIGKILL)
    base.wait_for_speed(0.0, "rest", before)
    wait_for(lambda: base.bulk_process != bulk, what="the next bulk process")
    base.wait_for_speed(SPEED, "navigation again", len(base.speeds()))
    before = len(base.speeds())
    light.turn("red")
    base.wait_for_speed(0.0, "rest at the red light", before)
