"""A rule over a type of the app's own, on a real ROS 2: the plan need not define it."""

import re

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from ros2_plans import driving, written

from rtron.vocabulary import (
    MSRCN,
    EventFlow,
    Flow,
    GuardedTopic,
    MissionRule,
    Mode,
    PolicyName,
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
