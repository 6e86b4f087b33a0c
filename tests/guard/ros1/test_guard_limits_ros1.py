"""The limits of the RSRCN between nodes of ROS 1: what a base hears."""

import pytest
from driven_base import start_guard
from harness import wait_for
from rostopic import TWIST, TopicEcho, say
from speed_limits import (
    NAV,
    OUT,
    SPEED,
    STRAIGHT,
    THRESHOLD,
    TOPIC,
    TURN,
    FilmingRobot,
    assert_speeds_up_by,
    assert_the_limit_falls_at_once_and_rises_slowly,
    assert_turns_at_most,
    limited,
)

from rtron.vocabulary import PolicyName

pytestmark = pytest.mark.ros1
TYPE, NODE = "geometry_msgs/Twist", "/rtron/rsrcn"


def navigate(ros1, yaml):
    say(ros1, "nav", TOPIC, TYPE, yaml, 50, f"{TOPIC}:={NAV}")


@pytest.mark.long
def test_a_camera_that_gets_slow_lowers_the_limit_at_once_and_it_rises_slowly(ros1):
    start_guard(ros1, limited(1, TYPE, policy=PolicyName.SAFE, threshold=THRESHOLD), NODE)
    robot = ros1.node("camera_base.py", "/robot", f"{TOPIC}:={OUT}")
    navigate(ros1, TWIST % SPEED)
    assert_the_limit_falls_at_once_and_rises_slowly(FilmingRobot(robot))


def commanded(ros1, **limits):
    """Return what a base is told until what it hears is `enough`."""
    plan = limited(1, TYPE, policy=PolicyName.CONSTRAIN, max_vel_limit=1.0, **limits)
    start_guard(ros1, plan, NODE)
    heard = TopicEcho(ros1, "robot", TOPIC, f"{TOPIC}:={OUT}")
    wait_for(lambda: ros1.connected(NODE, "/robot", OUT), what="the base's connection")
    navigate(ros1, f"{{linear: {{x: {STRAIGHT}}}, angular: {{z: {TURN}}}}}")

    def velocities_until(enough):
        rows = heard.wait_for(lambda rows: any(map(enough, rows)), "the limit")
        return [(row[0], row[5]) for row in rows]

    return velocities_until


def test_a_base_turns_no_faster_than_the_plan_allows(ros1):
    velocities = commanded(ros1, max_turn_limit=0.5)(lambda row: row[5] >= 0.5)
    assert_turns_at_most(velocities, 0.5)


def test_a_base_speeds_up_no_faster_than_the_plan_allows(ros1):
    velocities = commanded(ros1, max_accel_limit=0.25)(lambda row: row[0] >= STRAIGHT)
    assert_speeds_up_by(velocities, 0.25)
