"""The latched stop between nodes of ROS 2: over restarts, until all sources are released."""

import re
import signal

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from leased_base import NAV
from rclpy_nodes import twist
from ros2_plans import driving, written

from rtron.vocabulary import StopButton, StopSources, flow_topic, output_topic

pytestmark = pytest.mark.ros2
TOPIC = "/cmd_vel"
OUT = output_topic(TOPIC)
BOOL = "std_msgs/msg/Bool"
BUTTON = StopButton(name="red", topic="/estop", publisher="/estop_driver")
FREE, PRESSED = (b"\0\1\0\0" + bytes([each]) for each in (0, 1))


class Scene:
    """A guard in a domain, a driver behind it, and a node of rclpy that navigates."""

    def __init__(self, ros2, stand, *buttons):
        self.ros2 = ros2
        self.plan = ros2.folder / "rtron.yaml"
        self.plan.write_text(written(driving("nav"), stop_sources=StopSources(buttons=buttons)))
        self.driver = ros2.node("twist_subscriber.py", OUT, name="/driver")
        self.start_guard()
        self.robot = stand()
        self.nav = self.robot.publisher(NAV, flow_topic(TOPIC, "nav"))

    def start_guard(self):
        self.guard = self.ros2.rtron("guard", "--plan", self.plan)
        wait_for(lambda: "guarding 1 topics" in self.guard.log or self.guard.ended, what="it")
        assert not self.guard.ended, self.guard.log

    def speeds(self):
        return [float(each) for each in re.findall(r"speed (\S+)", self.driver.log)]

    def drive(self, speed):
        """Drive until the driver is told that speed, by a message from now on."""
        known = len(self.speeds())
        moves = f"{speed} m/s at the driver"
        self.robot.say_until(self.nav, twist(speed), lambda: speed in self.speeds()[known:], moves)

    def assert_stopped(self):
        """Assert that none of many commands reaches the driver."""
        known, count = len(self.speeds()), iter(range(200))
        self.robot.say_until(self.nav, twist(0.25), lambda: next(count) == 100, "commands")
        assert set(self.speeds()[known:]) <= {0.0}

    def rtron(self, *arguments):
        process = self.ros2.rtron(*arguments, "--plan", self.plan)
        wait_for(lambda: process.ended, what=" ".join(map(str, arguments)))
        return process.log


@pytest.mark.long
def test_a_stop_of_a_person_outlives_guard_and_supervisor(ros2, stand):
    scene = Scene(ros2, stand)
    scene.drive(0.25)
    assert scene.rtron("stop", "--reason", "a person on the track").startswith("stopped by ")
    wait_for(lambda: scene.speeds()[-1] == 0.0, what="rest")
    scene.assert_stopped()
    scene.guard.stop(signal.SIGKILL)
    scene.start_guard()
    wait_for(lambda: "still stopped, nobody has released it" in scene.guard.log, what="the stop")
    scene.assert_stopped()
    assert "a person on the track" in scene.rtron("release")
    released = "the stop of robot is released by"
    wait_for(lambda: released in scene.rtron("release", "robot", "--reason", "free"), what="it")
    scene.drive(0.25)


def test_a_button_stops_until_it_is_free_and_released(ros2, stand):
    scene = Scene(ros2, stand, BUTTON)
    scene.assert_stopped()
    button = scene.robot.publisher(BUTTON.publisher, BUTTON.topic, BOOL)
    known = len(scene.speeds())

    def drives():
        scene.nav.publish(twist(0.25))
        return 0.25 in scene.speeds()[known:]

    scene.robot.say_until(button, FREE, drives, "the navigation")
    stopped = "stopped by red: /estop_driver, pressed"
    scene.robot.say_until(button, PRESSED, lambda: stopped in scene.guard.log, "the stop")
    wait_for(lambda: scene.speeds()[-1] == 0.0, what="rest")
    refused = "the cause of the stop of red is still there: pressed"
    assert refused in scene.rtron("release", "red", "--reason", "test")

    def is_released():
        return "is released by" in scene.rtron("release", "red", "--reason", "test")

    scene.robot.say_until(button, FREE, is_released, "the release")
    scene.drive(0.25)
