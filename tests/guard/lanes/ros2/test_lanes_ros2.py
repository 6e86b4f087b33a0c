"""The processes of the guard between nodes of rclpy: what is not known of frames and events."""

import os
import re
import signal

import pytest
from harness import lives, wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy_nodes import STRING, TWIST

from rtron.guard.core.report_messages import string_message
from rtron.messages.common.encoding import Encoding
from rtron.planning import write_plan
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    EventFlow,
    Flow,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    Plan,
    PolicyName,
    Supervision,
    flow_topic,
    output_topic,
)

pytestmark = [pytest.mark.ros2, pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])]
SPEED = 0.8
NAV, OUT = flow_topic("/cmd_vel", "nav"), output_topic("/cmd_vel")
MOVING = GuardedTopic(
    topic="/cmd_vel",
    type=TWIST,
    flows=(Flow(name="nav", publisher="/nav", silent_after=8 * SECOND),),
    successors=("/driver",),
)
SAFE = RSRCN(
    id="rsrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.SAFE,
    vflows=(MOVING,),
    threshold=1.0,
    max_accel_limit=5.0,
)
PATIENCE = 10 * SECOND
"""So long a silent node stops nothing: only the age of what the bulk process has written does."""
DETECTOR = FpsMonitor(
    id="fps_detector",
    node="/detector",
    topic="/detector/image",
    window=PATIENCE,
    silent_after=PATIENCE,
)
LIGHT = EventFlow(
    name="red",
    topic="/light",
    publisher="/light",
    type=STRING,
    when="event.data == 'red'",
    max_age=PATIENCE,
)
MISSION = MSRCN(
    id="msrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.BLOCK,
    aflows=(MOVING,),
    eflows=(LIGHT,),
    rules=(MissionRule(name="light", when="red", block=("/cmd_vel",)),),
)


class LanedBase2:
    """A driver behind the guard; navigation drives at full speed.

    The supervisor does not stop the robot of a guard that is late on a busy machine.
    """

    def __init__(self, ros2, **plan):
        path = ros2.folder / "rtron.yaml"
        slow = Supervision(stall_after=SECOND // 5)
        path.write_text(write_plan(Plan(app="robot", ros=2, revision=1, supervision=slow, **plan)))
        self.guard = ros2.rtron("guard", "--plan", path)
        wait_for(lambda: "guarding 1 topics" in self.guard.log or self.guard.ended, what="guard")
        assert not self.guard.ended, self.guard.log
        self.driver = ros2.node("twist_subscriber.py", OUT, name="/driver")
        ros2.node("twist_publisher.py", NAV, SPEED, "20", name="/nav")

    def speeds(self):
        return [float(x) for x in re.findall(r"speed (\S+)\n", self.driver.log)]

    def heard(self, speed, since):
        """Tell whether the driver was told a speed after the first `since` ones."""
        return speed in self.speeds()[since:]

    @property
    def bulk_process(self):
        return int(re.findall(r"the bulk process is there, process (\d+)", self.guard.log)[-1])

    def lose_bulk_process(self, number, wait_for):
        """Kill or freeze the bulk process; return when the robot rests and the next one is there.

        A frozen one is still there when the robot rests: its numbers are old, and that suffices.
        """
        bulk, before, logged = self.bulk_process, len(self.speeds()), len(self.guard.log)
        os.kill(bulk, number)
        wait_for(lambda: self.heard(0.0, before), what="rest")
        wait_for(lambda: not lives(bulk), what="the end of the bulk process")
        wait_for(lambda: self.bulk_process != bulk, what="the next bulk process")
        log = self.guard.log[logged:]
        is_killed, gone = number == signal.SIGKILL, log.index("the bulk process is gone")
        assert is_killed or log.index("/cmd_vel: stopping") < gone, log

    def assert_never_faster(self):
        assert max(self.speeds()) == SPEED
        assert self.guard.log.count("the guard begins") == 1


@pytest.mark.long
def test_without_the_process_that_counts_frames_the_robot_rests(ros2, number):
    base = LanedBase2(ros2, rsrcn=SAFE, fps_monitor=(DETECTOR,))
    ros2.node("image_publisher.py", DETECTOR.topic, "1000", "20", name="/detector")
    wait_for(lambda: base.heard(SPEED, 0), what="navigation")
    base.lose_bulk_process(number, wait_for)
    before = len(base.speeds())
    wait_for(lambda: base.heard(SPEED, before), what="navigation again")
    base.assert_never_faster()


def test_without_the_process_that_reads_events_a_rule_blocks(ros2, stand, number):
    base, place = LanedBase2(ros2, msrcn=MISSION), stand()
    light = place.publisher("/light", LIGHT.topic, STRING)

    def shows(color):
        """Return what waits for a condition while the light shows a color."""
        text = string_message(Encoding.CDR, color)
        return lambda condition, what: place.say_until(light, text, condition, what)

    green, red = shows("green"), shows("red")
    green(lambda: base.heard(SPEED, 0), what="navigation")
    base.lose_bulk_process(number, green)
    before = len(base.speeds())
    green(lambda: base.heard(SPEED, before), what="navigation again")
    before = len(base.speeds())
    red(lambda: base.heard(0.0, before), what="rest at the red light")
    base.assert_never_faster()
