"""The guard on a real ROS 2 among nodes that say what they should not: none of it passes."""

import math
import os
import random
import signal
import struct
import sys
from contextlib import suppress
from dataclasses import replace
from functools import partial

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy._rclpy_pybind11 import RCLError
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy_nodes import IMAGE, STRING
from ros2_plans import driving, telling, written

from rtron.messages.common.encoding import PADDING
from rtron.vocabulary import OnSilence, flow_topic, output_topic

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
PLAN = written(
    driving("nav", "teleop", on_silence=OnSilence.RELEASE),
    telling("/words", STRING, "/speaker", "nav", "teleop"),
    telling("/image", IMAGE, "/detector", "camera", "other"),
)
NAV, OUT = flow_topic("/cmd_vel", "nav"), output_topic("/cmd_vel")
WORDS, WORDS_OUT = flow_topic("/words", "nav"), output_topic("/words")
FRONT = b"\0\1\0\0"
PIXELS = 4_000_000
CAMERA = f"""
import sys, rclpy
from sensor_msgs.msg import Image
rclpy.init()
node = rclpy.create_node(sys.argv[1])
publisher = node.create_publisher(Image, sys.argv[2], 1)
image = Image(height=1, width={PIXELS}, step={PIXELS}, encoding="mono8", data=bytes({PIXELS}))
while True:
    publisher.publish(image)
"""


@pytest.fixture
def outside(stand):
    """Stand in the test's domain."""
    return stand()


@pytest.fixture
def guard(ros2):
    """Have the guard; it lives to the end."""
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    wait_for(lambda: "guarding 3 topics" in guard.log or guard.ended, what="the guard")
    yield guard
    assert not guard.ended, guard.log
    assert "internal error" not in guard.log
    assert guard.log.count("the guard begins") == 1, guard.log


def twist(speed):
    return FRONT + struct.pack("<6d", speed, 0, 0, 0, 0, 0)


def assert_only_navigation_arrived(driver, *speeds):
    """What navigation said, and what slows down: on a busy machine a late guard's supervisor stops.

    Each message is a velocity straight ahead, at most as fast as navigation has ever been.
    """
    assert set(map(twist, speeds)) <= set(driver)
    arrived = {struct.unpack_from("<d", each, len(FRONT))[0] for each in driver}
    assert set(map(twist, arrived)) == set(driver)
    assert 0 <= min(arrived) <= max(arrived) <= max(speeds)


def string(text):
    return FRONT + struct.pack("<I", len(text) + 1) + text + b"\0"


def garbage(message, seed, count):
    """Return messages that are near a well-formed one, and others that are far from any.

    DDS fills up to 4 bytes: what is only that much shorter or longer, is well-formed.
    """
    choose = random.Random(seed)
    found = [
        message + bytes(8),
        message + bytes(100_000),
        message[:-5],
        message[:5],
        FRONT,
        b"\0\0" + message[2:],
        b"\xff" * 60,
    ]
    while len(found) < count:
        data = bytes(choose.randrange(256) for _ in range(choose.randrange(1, 80)))
        found.append(choose.choice([data, FRONT + data, message[: choose.randrange(40)] + data]))
    return [each for each in found if abs(len(each) - len(message)) > PADDING]


def test_garbage_of_approved_nodes_never_passes(guard, outside):
    driver = outside.listener("/driver", OUT)
    nav = outside.publisher("/nav", NAV)
    outside.say_until(nav, twist(0.5), lambda: twist(0.5) in driver, "the navigation")
    bad = garbage(twist(9.0), 1, 300)
    for number, each in enumerate(bad):
        with suppress(RCLError):  # what is too long for its type, Fast DDS does not even send
            nav.publish(each)
        if number % 20 == 0:
            nav.publish(twist(0.25))
    outside.say_until(nav, twist(0.125), lambda: twist(0.125) in driver, "the navigation after it")
    assert_only_navigation_arrived(driver, 0.5, 0.25, 0.125)
    assert f"{NAV}: /nav a message is dropped: " in guard.log


def test_what_is_no_number_never_passes(guard, outside):
    """A GRCN alone never looked into a velocity."""
    driver = outside.listener("/driver", OUT)
    nav = outside.publisher("/nav", NAV)
    outside.say_until(nav, twist(0.5), lambda: twist(0.5) in driver, "the navigation")
    for bad, after in ((math.nan, 0.25), (math.inf, 0.125), (-math.inf, 0.0625)):
        for at in range(6):
            values = [0.0] * 6
            values[at] = bad
            nav.publish(FRONT + struct.pack("<6d", *values))
        heard = partial(driver.__contains__, twist(after))
        outside.say_until(nav, twist(after), heard, f"the navigation after {bad}")
    assert_only_navigation_arrived(driver, 0.5, 0.25, 0.125, 0.0625)


@pytest.mark.long
def test_what_the_base_does_not_use_never_passes(ros2, outside):
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(written(replace(driving("nav"), uses=("linear.x", "angular.z"))))
    guard = ros2.rtron("guard", "--plan", plan)
    wait_for(lambda: "guarding 1 topics" in guard.log, what="the guard")
    driver = outside.listener("/driver", OUT)
    nav = outside.publisher("/nav", NAV)
    tumbling = FRONT + struct.pack("<6d", 0.2, 3, 3, 31, 31, 0)
    outside.say_until(nav, tumbling, lambda: twist(0.2) in driver, "the navigation")
    assert_only_navigation_arrived(driver, 0.2)


@pytest.mark.long
def test_garbage_in_what_no_policy_reads_never_passes(guard, outside):
    heard = outside.listener("/speaker", WORDS_OUT, STRING)
    nav = outside.publisher("/nav", WORDS, STRING)
    outside.say_until(nav, string(b"one"), lambda: heard, "the words")
    bad = [
        FRONT + struct.pack("<I", (1 << 32) - 1) + b"a\0",
        FRONT + struct.pack("<I", 0),
        FRONT + struct.pack("<I", 2) + b"ab",
        string(b"a\0b"),
        string(b"one") + bytes(8),
    ]
    for each in bad:
        nav.publish(each)
    outside.say_until(nav, string(b"two"), lambda: string(b"two") in heard, "the words after it")
    assert set(heard) == {string(b"one"), string(b"two")}
    wait_for(lambda: f"{WORDS}: /nav a message is dropped" in guard.log, what="the event")


@pytest.mark.long
@pytest.mark.parametrize("topic", [NAV, "/cmd_vel"])
def test_two_types_on_one_topic(guard, outside, stand, topic):
    driver = outside.listener("/driver", OUT)
    elsewhere = stand()
    other = elsewhere.publisher("/teleop", topic, STRING)
    nav = outside.publisher("/nav", NAV)
    elsewhere.say_until(
        other, string(b"x" * 43), lambda: "std_msgs/msg/String" in guard.log, "a word"
    )
    outside.say_until(nav, twist(0.5), lambda: twist(0.5) in driver, "the navigation")
    other.publish(string(b"x" * 43))
    outside.say_until(nav, twist(0.25), lambda: twist(0.25) in driver, "the navigation after it")
    assert_only_navigation_arrived(driver, 0.5, 0.25)
    assert f"{topic}: /teleop is ignored: it publishes std_msgs/msg/String" in guard.log


@pytest.mark.long
def test_publishers_and_subscribers_that_do_not_fit(guard, outside):
    """One that asks for more than is offered hears nothing; others are served all the same."""
    best_effort = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    latched = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    driver = outside.listener("/driver", OUT, profile=best_effort)
    demanding = outside.listener("/driver", OUT, profile=latched)
    nav = outside.publisher("/nav", NAV, profile=best_effort)
    outside.say_until(nav, twist(0.5), lambda: driver, "the navigation")
    assert demanding == []
    teleop = outside.publisher("/teleop", flow_topic("/cmd_vel", "teleop"))
    outside.wait_for(lambda: "its publishers differ in QoS" in guard.log, "the event")
    reliable = outside.listener("/driver", OUT)
    outside.say_until(nav, twist(0.25), lambda: twist(0.25) in reliable, "what fits both")
    teleop.publish(twist(9.0))
    assert twist(9.0) not in driver


@pytest.mark.long
def test_a_node_that_dies_in_the_middle_of_large_messages(ros2, guard, outside):
    """What arrives of them is whole, and another camera is heard after it."""
    detector = outside.listener("/detector", output_topic("/image"), IMAGE, 10)
    sizes = set()

    def count():
        sizes.update(map(len, detector))
        found = len(detector)
        detector.clear()
        return found

    for name in ("camera", "other"):
        topic = flow_topic("/image", name)
        camera = ros2.spawn(sys.executable, "-c", CAMERA, name, topic)
        outside.wait_for(count, "an image")
        os.kill(camera.pid, signal.SIGKILL)
    outside.wait_for(lambda: not count(), "silence")
    assert len(sizes) == 1
    assert sizes.pop() >= PIXELS
    words = outside.listener("/speaker", WORDS_OUT, STRING)
    nav = outside.publisher("/nav", WORDS, STRING)
    outside.say_until(nav, string(b"one"), lambda: words, "another topic")
