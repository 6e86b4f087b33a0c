"""What publishers of ROS 2 have kept is done once, also by a guard that was started again."""

import os
import re
import signal
import struct

import pytest
from harness import wait_for

pytest.importorskip("rclpy")
from outside2 import STRING, kept, twist

from rtron.vocabulary import flow_topic, output_topic

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
PLAN = """
schema: rtron.plan/1
app: robot
ros: 2
revision: 1
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/msg/Twist
    mode: enforce
    policy: Preemption
    successors: [/robot]
    flows: [{name: nav, publisher: /nav, priority: 1}]
  - id: grcn_goal
    topic: /goal
    type: std_msgs/msg/String
    mode: enforce
    kind: action
    policy: Block
    successors: [/robot]
    flows: [{name: nav, publisher: /nav}]
"""
FRONT = b"\0\1\0\0"


def goal(text):
    return FRONT + struct.pack("<I", len(text) + 1) + text + b"\0"


def lives(guard):
    """Return the processes of the guard so far, the last of which guards."""
    return re.findall(r"the guard begins, process (\d+)", guard.log)


def test_a_guard_that_was_killed_is_followed_by_one_that_does_nothing_again(ros2, stand):
    robot, app = stand(), stand()
    goals = robot.listener("/robot", output_topic("/goal"), STRING, kept(100))
    driven = robot.listener("/robot", output_topic("/cmd_vel"), profile=kept(100))
    nav = app.publisher("/nav", flow_topic("/goal", "nav"), STRING, kept(3))
    drive = app.publisher("/nav", flow_topic("/cmd_vel", "nav"), profile=kept(1))
    for each in (b"one", b"two", b"six"):
        nav.publish(goal(each))
    drive.publish(twist(0.5))
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    wait_for(lambda: "guarding 2 topics" in guard.log or guard.ended, what="the guard")
    assert not guard.ended, guard.log
    robot.wait_for(lambda: len(goals) == 3 and twist(0.5) in driven, "what was kept")
    os.kill(int(lives(guard)[-1]), signal.SIGKILL)
    wait_for(lambda: len(lives(guard)) == 2, what="the next guard")
    nav.publish(goal(b"ten"))
    robot.wait_for(lambda: len(goals) == 4, "a goal for the next guard")
    nav.publish(goal(b"six"))
    drive.publish(twist(0.25))
    robot.wait_for(lambda: len(goals) == 5 and twist(0.25) in driven, "what is said again")
    assert goals == [goal(each) for each in (b"one", b"two", b"six", b"ten", b"six")]
    assert driven.count(twist(0.5)) == 1
