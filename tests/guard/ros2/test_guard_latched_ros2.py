"""Goals that publishers of ROS 2 have kept are done once, also by a guard that was started again.

Commands from before the guard listened are not done at all, nor what waits while it is stalled.
"""

import os
import re
import signal
import struct
import time
from pathlib import Path

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy_nodes import STRING, kept, twist

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


def heartbeat(domain):
    """Return when the guard of a domain has last said that it is there, ns."""
    (file,) = Path(os.environ["XDG_RUNTIME_DIR"]).rglob(f"*domain_{domain}.heartbeat")
    return file.stat().st_mtime_ns


def lives(guard):
    """Return the processes of the guard so far, the last of which guards."""
    return re.findall(r"the guard begins, process (\d+)", guard.log)


@pytest.mark.long
def test_a_guard_that_was_killed_is_followed_by_one_that_does_nothing_again(ros2, stand):
    robot, app = stand(), stand()
    goals = robot.listener("/robot", output_topic("/goal"), STRING, kept(100))
    driven = robot.listener("/robot", output_topic("/cmd_vel"), profile=kept(100))
    nav = app.publisher("/nav", flow_topic("/goal", "nav"), STRING, kept(3))
    drive = app.publisher("/nav", flow_topic("/cmd_vel", "nav"), profile=kept(10))
    for each in (b"one", b"two", b"six"):
        nav.publish(goal(each))
    drive.publish(twist(6))
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    robot.wait_for(lambda: "guarding 2 topics" in guard.log or guard.ended, "the guard")
    assert not guard.ended, guard.log
    robot.wait_for(lambda: len(goals) == 3, "the goals that were kept")
    robot.say_until(drive, twist(0.5), lambda: twist(0.5) in driven, "the command of the moment")
    drive.publish(twist(0.75))
    robot.wait_for(lambda: twist(0.75) in driven, "one command")
    driven.clear()
    os.kill(int(lives(guard)[-1]), signal.SIGKILL)
    wait_for(lambda: len(lives(guard)) == 2, what="the next guard")
    nav.publish(goal(b"ten"))
    robot.wait_for(lambda: len(goals) == 4, "a goal for the next guard")
    nav.publish(goal(b"six"))
    robot.say_until(drive, twist(0.25), lambda: twist(0.25) in driven, "the next command")
    robot.wait_for(lambda: len(goals) == 5, "what is said again")
    assert goals == [goal(each) for each in (b"one", b"two", b"six", b"ten", b"six")]
    assert not {twist(6), twist(0.5), twist(0.75)} & set(driven)


@pytest.mark.long
def test_after_a_restart_of_the_whole_what_was_kept_is_old(ros2, stand):
    robot, app = stand(), stand()
    goals = robot.listener("/robot", output_topic("/goal"), STRING, kept(100))
    driven = robot.listener("/robot", output_topic("/cmd_vel"), profile=kept(100))
    nav = app.publisher("/nav", flow_topic("/goal", "nav"), STRING, kept(3))
    drive = app.publisher("/nav", flow_topic("/cmd_vel", "nav"), profile=kept(10))
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    nav.publish(goal(b"one"))
    robot.wait_for(lambda: goals, "the goal")
    heard = time.time_ns()
    wait_for(lambda: heartbeat(ros2.domain) > heard, what="a sign of life after it")
    guard.tell(signal.SIGTERM)
    wait_for(lambda: guard.ended, what="the end of the guard")
    nav.publish(goal(b"two"))
    drive.publish(twist(0.75))
    ros2.rtron("guard", "--plan", plan)
    robot.wait_for(lambda: goal(b"two") in goals, "what was said while no guard was there")
    robot.say_until(drive, twist(0.25), lambda: twist(0.25) in driven, "the next command")
    assert goals == [goal(b"one"), goal(b"two")]
    assert twist(0.75) not in driven


@pytest.mark.long
def test_a_guard_that_was_stalled_does_not_do_what_has_waited(ros2, stand):
    robot, app = stand(), stand()
    driven = robot.listener("/robot", output_topic("/cmd_vel"))
    drive = app.publisher("/nav", flow_topic("/cmd_vel", "nav"))
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    robot.say_until(drive, twist(0.5), lambda: driven.count(twist(0.5)) > 5, "the navigation")
    guard.tell(signal.SIGSTOP)
    for _ in range(20):
        drive.publish(twist(6))
    said = time.monotonic()
    wait_for(lambda: time.monotonic() - said > 1, what="that the words are old")
    guard.tell(signal.SIGCONT)
    robot.say_until(drive, twist(0.25), lambda: twist(0.25) in driven, "the next command")
    assert twist(6) not in driven
    assert "a late command is dropped" in guard.log
