"""The limits of the RSRCN between nodes of rclpy: what a base hears."""

import struct

import pytest
from harness import NODES, wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy_nodes import TWIST
from speed_limits import (
    NAV,
    OUT,
    SPEED,
    STRAIGHT,
    THRESHOLD,
    TURN,
    FilmingRobot,
    assert_speeds_up_by,
    assert_the_limit_falls_at_once_and_rises_slowly,
    assert_turns_at_most,
    limited,
)

from rtron.planning import write_plan
from rtron.vocabulary import PolicyName

pytestmark = pytest.mark.ros2


def start_guard(ros2, **limits):
    path = ros2.folder / "rtron.yaml"
    path.write_text(write_plan(limited(2, TWIST, **limits)))
    guard = ros2.rtron("guard", "--plan", path)
    wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
    assert not guard.ended, guard.log


def test_a_camera_that_gets_slow_lowers_the_limit_at_once_and_it_rises_slowly(ros2):
    start_guard(ros2, policy=PolicyName.SAFE, threshold=THRESHOLD)
    robot = ros2.node("camera_base2.py", OUT, name="/robot", PYTHONPATH=str(NODES))
    ros2.node("twist_publisher.py", NAV, SPEED, "50", name="/nav")
    assert_the_limit_falls_at_once_and_rises_slowly(FilmingRobot(robot))


@pytest.fixture
def commanded(ros2, stand):
    """Return what a base is told under limits until what it hears is enough."""

    def velocities_until(enough, **limits):
        start_guard(ros2, policy=PolicyName.CONSTRAIN, max_vel_limit=1.0, **limits)
        base, app = stand(), stand()
        heard = base.listener("/robot", OUT)
        nav = app.publisher("/nav", NAV)
        asked = b"\0\1\0\0" + struct.pack("<6d", STRAIGHT, 0, 0, 0, 0, TURN)

        def velocities():
            nav.publish(asked)
            told = (struct.unpack("<6d", bytes(each)[4:52]) for each in heard)
            return [(each[0], each[5]) for each in told]

        base.wait_for(lambda: any(map(enough, velocities())), "the limit")
        return velocities()

    return velocities_until


def test_a_base_turns_no_faster_than_the_plan_allows(commanded):
    velocities = commanded(lambda told: told[1] >= 0.5, max_turn_limit=0.5)
    assert_turns_at_most(velocities, 0.5)


@pytest.mark.long
def test_a_base_speeds_up_no_faster_than_the_plan_allows(commanded):
    velocities = commanded(lambda told: told[0] >= STRAIGHT, max_accel_limit=0.25)
    assert_speeds_up_by(velocities, 0.25)
