"""A rule over a type of the app's own, on a real ROS 2: the plan need not define it."""

import re
import struct
from itertools import pairwise

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from ros2_plans import driving, written

from rtron.vocabulary import (
    MSRCN,
    SECOND,
    EventFlow,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    PolicyName,
    StopProfile,
    flow_topic,
    output_topic,
)
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
CUSTOM, TOPIC = "test_msgs/msg/Arrays", "/wear"
NAV = (Flow(name="aflow1", publisher="/nav"),)
TWIST = "geometry_msgs/msg/Twist"
MISSION = MSRCN(
    id="msrcn",
    mode=Mode.ENFORCE,
    policy=PolicyName.BLOCK,
    aflows=(GuardedTopic(topic="/cmd_vel", type=TWIST, flows=NAV, successors=("/driver",)),),
    eflows=(
        EventFlow(
            name="worn",
            topic=TOPIC,
            publisher="/arm",
            type=CUSTOM,
            when="event.basic_types_values[2].int32_value > 7",
            max_age=60 * 10**9,
        ),
    ),
    rules=(MissionRule(name="rest", when="worn", block=("/cmd_vel",)),),
)


@pytest.fixture
def arm(ros2, monkeypatch):
    """Say how worn the arm is."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    session = Ros2Session(ros2.domain)
    cls = find_interface(CUSTOM).cls
    publisher = session.node("/arm").create_publisher(cls, TOPIC, 1)

    def say(hours):
        message = cls()
        message.basic_types_values[2].int32_value = hours
        publisher.publish(message)

    yield say
    session.close()


def test_an_event_of_an_installed_type_blocks(ros2, arm):
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(written(driving("nav"), msrcn=MISSION))
    guard = ros2.rtron("guard", "--plan", plan)
    driver = ros2.node("twist_subscriber.py", output_topic("/cmd_vel"), name="/driver")
    ros2.node("twist_publisher.py", flow_topic("/cmd_vel", "nav"), "0.5", "20", name="/nav")

    def heard():
        return len(re.findall("speed 0.5", driver.log))

    def drives():
        arm(7)
        return heard()

    wait_for(drives, what="the navigation, once the arm is known to be well")

    def rests():
        arm(8)
        return "blocked: rule rest" in guard.log

    wait_for(rests, what="the rule")
    before = heard()
    wait_for(lambda: driver.log.rstrip().endswith("speed 0.0"), what="the stop")
    assert heard() <= before + 5
    assert not guard.ended, guard.log


@pytest.mark.long
def test_a_turn_that_no_base_drives_does_not_keep_the_robot_going(ros2, arm, stand):
    """Each part of a stop ends in its time, and all within the bound of the plan."""
    plan, stop = ros2.folder / "rtron.yaml", StopProfile()
    plan.write_text(written(driving("nav"), msrcn=MISSION))
    guard = ros2.rtron("guard", "--plan", plan)
    robot = stand()
    driver = robot.listener("/driver", output_topic("/cmd_vel"))
    nav = robot.publisher("/nav", flow_topic("/cmd_vel", "nav"))
    spinning, rest = spin(0.2, 31.0), spin(0.0, 0.0)

    def says(hours):
        arm(hours)
        nav.publish(spinning)

    robot.wait_for(lambda: says(7) or spinning in driver, "the navigation")
    robot.wait_for(lambda: says(8) or "blocked: rule rest" in guard.log, "the rule")
    robot.wait_for(lambda: driver[-1] == rest, "the stop")
    last = max(at for at, message in enumerate(driver) if message == spinning)
    wave = [
        struct.unpack("<6d", each[4:52]) for each in driver[last + 1 : driver.index(rest, last)]
    ]
    assert len(wave) <= stop.within / stop.period + 2
    assert sum(six[0] > 0 for six in wave) <= 0.2 / stop.decel * SECOND / stop.period + 2
    assert all(one[3] >= other[3] for one, other in pairwise(wave))


def spin(speed, turn):
    return b"\0\1\0\0" + struct.pack("<6d", speed, 0.0, 0.0, turn, 0.0, 0.0)
