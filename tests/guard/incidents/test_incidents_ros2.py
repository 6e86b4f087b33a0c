"""Incidents of a guard between real nodes of ROS 2."""

from dataclasses import replace

import pytest
from guarded_drive import ALLOWED, FAST, speed_plan
from harness import wait_for
from incident_checks import (
    CMD,
    check_limited_drive,
    check_messages_are_their_schemas,
    wait_for_incident,
)

pytest.importorskip("rclpy", reason="needs ROS 2")

from rtron.planning.plan_file.writer import write_plan
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import flow_topic, output_topic
from rtron.workflows.incidents import read_account
from rtron.workflows.what_if import as_it_was, without_guard

pytestmark = pytest.mark.ros2
TELEOP, OUT = flow_topic(CMD, "flow1"), output_topic(CMD)
TYPE = "geometry_msgs/msg/Twist"


def ros2_plan(app):
    """Return the plan of a base that may drive at 0.25 m/s, for ROS 2."""
    plan = speed_plan(app)
    grcn = tuple(replace(each, type=TYPE) for each in plan.grcn)
    vflows = tuple(replace(each, type=TYPE) for each in plan.rsrcn.vflows)
    return replace(plan, ros=2, grcn=grcn, rsrcn=replace(plan.rsrcn, vflows=vflows))


@pytest.fixture
def drive(ros2):
    """Return what starts a guard and a node that drives at a speed behind it."""

    def start(app, speed):
        path = ros2.folder / "rtron.yaml"
        path.write_text(write_plan(ros2_plan(app)))
        guard = ros2.rtron("guard", "--plan", path)
        wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
        base = ros2.node("twist_subscriber.py", OUT, name="/base")
        ros2.node("twist_publisher.py", TELEOP, str(speed), "20", name="/teleop")
        wait_for(lambda: f"speed {min(speed, ALLOWED)}" in base.log, what="the drive at the base")
        return guard

    return start


def test_a_drive_that_is_too_fast_is_an_incident_with_all_that_decided_it(drive):
    drive("incident_fast_ros2", FAST)
    path = wait_for_incident("incident_fast_ros2")
    check_limited_drive(path, 2, "/teleop")
    check_messages_are_their_schemas(path, 2)
    opened = IncidentFile(path)
    account = read_account(opened)
    assert {each.speed for _, each in without_guard(account).outputs[CMD]} == {FAST}
    assert max(each.speed for _, each in as_it_was(opened).outputs[CMD]) == ALLOWED


@pytest.mark.long
def test_an_intruder_is_an_incident_with_its_messages(ros2, drive):
    drive("incident_intruder_ros2", 0.1)
    ros2.node("twist_publisher.py", CMD, "9.0", "200", name="/evil")
    account = read_account(IncidentFile(wait_for_incident("incident_intruder_ros2")))
    assert account.topics[CMD].verdicts["unapproved", "drop"] > 10
    assert max(each.speed for _, each in account.topics[CMD].output) <= ALLOWED
