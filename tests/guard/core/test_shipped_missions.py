"""The missions that RTron ships do what the paper's table of mission-specific risks asks for."""

import pytest
from app_in_memory import App, made

from rtron.planning.missions import MISSIONS, mission_text
from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import SECOND


def app(name):
    return App(parse_plan(mission_text(name), f"{name}.yaml"))


def drive(x=0.5):
    return {"linear": made("geometry_msgs/Vector3", x=x)}


def at(x, y, frame="map"):
    point = made("geometry_msgs/Point", x=x, y=y)
    return {
        "header": made("std_msgs/Header", frame_id=frame),
        "pose": made("geometry_msgs/Pose", position=point),
    }


def odom(x, y, frame="odom"):
    pose = made("geometry_msgs/Pose", position=made("geometry_msgs/Point", x=x, y=y))
    return {
        "header": made("std_msgs/Header", frame_id=frame),
        "pose": made("geometry_msgs/PoseWithCovariance", pose=pose),
    }


def people(*places, frame="base_link"):
    points = [made("geometry_msgs/Point", x=x, y=y) for x, y in places]
    return {
        "header": made("std_msgs/Header", frame_id=frame),
        "poses": [made("geometry_msgs/Pose", position=point) for point in points],
    }


def test_the_paper_s_eight_examples_and_its_case_are_there():
    assert set(MISSIONS) == {
        "companion_alert",
        "sleeping_user",
        "limited_weight",
        "recharge",
        "red_light",
        "safe_distance",
        "wounded_alert",
        "surgical_precision",
        "unstable_area",
    }


@pytest.mark.parametrize("name", MISSIONS)
def test_nothing_is_allowed_while_nobody_tells_what_is_going_on(name):
    """Unless a rule is about the action alone, or about somebody who was seen."""
    started = app(name)
    blocking = [
        each for each in started.host.observations.mission.statuses.values() if each.is_blocking
    ]
    assert blocking


def test_companion_alert():
    robot = app("companion_alert")
    robot.event("/user_state", data="fine")
    assert robot.act("move_base", **drive())
    robot.event("/user_state", data="danger")
    assert not robot.act("move_base", **drive())
    assert "no alert was sent" in robot.reason("move_base")
    assert robot.act("alert", data="help")
    assert robot.act("move_base", **drive())


def test_sleeping_user():
    robot = app("sleeping_user")
    robot.event("/user_state", data="awake")
    assert robot.act("coverage", **drive())
    assert robot.act("fan", data=True)
    robot.event("/user_state", data="asleep")
    assert not robot.act("coverage", **drive())
    assert not robot.act("fan", data=True)
    assert robot.act("fan", data=False)


@pytest.mark.parametrize(("weight", "lifts"), [(1.9, 1), (2.0, 1), (2.1, 0), (float("nan"), 0)])
def test_limited_weight(weight, lifts):
    robot = app("limited_weight")
    robot.event("/scale/weight", data=weight)
    assert robot.act("grasp", data=True) is bool(lifts)
    assert robot.act("grasp", data=False)


@pytest.mark.parametrize(
    ("percentage", "status", "controller_on_each_database"),
    [(0.9, 2, 1), (0.2, 2, 1), (0.19, 2, 0), (0.1, 1, 1), (float("nan"), 2, 0)],
)
def test_recharge(percentage, status, controller_on_each_database):
    robot = app("recharge")
    robot.event("/battery_state", percentage=percentage, power_supply_status=status)
    assert robot.act("orders", **at(5.0, 5.0)) is bool(controller_on_each_database)
    assert robot.act("orders", **at(0.5, 0.5))


def test_red_light():
    robot = app("red_light")
    for color, goes in (("green", True), ("yellow", False), ("red", False), ("green", True)):
        robot.event("/traffic_light", data=color)
        assert robot.act("follow", **drive()) is goes
    robot.transport.advance(2 * SECOND)
    assert not robot.act("follow", **drive())


@pytest.mark.parametrize(
    ("seen", "goes"),
    [
        (people(), True),
        (people((3.0, 0.0), (0.0, -1.6)), True),
        (people((3.0, 0.0), (0.0, -1.4)), False),
        (people((3.0, 0.0), frame="camera"), False),
        (people((float("nan"), 0.0)), False),
    ],
)
def test_safe_distance(seen, goes):
    robot = app("safe_distance")
    robot.event("/people", **seen)
    assert robot.act("follow", **drive()) is goes


def test_wounded_alert():
    robot = app("wounded_alert")
    robot.event("/detections", data="chair")
    assert robot.act("search", **at(1.0, 1.0))
    robot.event("/detections", data="wounded")
    robot.event("/detections", data="chair")
    assert not robot.act("search", **at(1.0, 1.0))
    assert robot.act("alert", **at(2.0, 2.0))
    assert robot.act("search", **at(1.0, 1.0))


def test_surgical_precision():
    robot = app("surgical_precision")
    robot.event("/tool/error", data=0.0004)
    assert robot.act("surgeon", **at(0.0, 0.0))
    robot.transport.advance(SECOND // 10)
    assert not robot.act("surgeon", **at(0.0, 0.0))
    robot.event("/tool/error", data=0.0006)
    assert not robot.act("surgeon", **at(0.0, 0.0))


def test_unstable_area():
    robot = app("unstable_area")
    robot.event("/odom", **odom(1.0, 1.0))
    assert robot.act("rviz", **at(5.0, 2.0))
    assert not robot.act("monitor", **at(7.0, 2.0))
    assert "no network at this goal" in robot.reason("monitor")
    assert robot.act("move_base", **drive())
    robot.event("/odom", **odom(7.0, 2.0))
    assert not robot.act("move_base", **drive())
    assert robot.act("teleop", **drive(-0.2))
