"""A command that leaves the launch: the base, started apart, hears the app through the guard."""

import pytest
from harness import wait_for
from leaving_topics import INPUT, REFUSED, TOPIC, leaving

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy_nodes import TWIST, twist

from rtron.planning import write_plan
from rtron.vocabulary import SUPERVISOR_NODE

pytestmark = pytest.mark.ros2


def test_a_base_apart_hears_the_app_through_the_guard_and_a_stranger_beside_it(ros2, stand):
    path = ros2.folder / "rtron.yaml"
    path.write_text(write_plan(leaving(2, TWIST)))
    guard = ros2.rtron("guard", "--plan", path)
    wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
    base, app, beside = stand(), stand(), stand()
    heard = base.listener("/base", TOPIC)
    nav = app.publisher("/nav", INPUT)
    base.say_until(nav, twist(0.5), lambda: twist(0.5) in heard, "the app's command")
    names = {"msrcn", SUPERVISOR_NODE.strip("/")}
    publishers = base.node("/base").get_publishers_info_by_topic
    base.wait_for(lambda: {e.node_name for e in publishers(TOPIC)} == names, "guard and supervisor")
    assert "unapproved publisher" not in guard.log
    stranger = beside.publisher("/stranger", TOPIC)
    base.say_until(stranger, twist(9.0), lambda: twist(9.0) in heard, "the stranger's command")
    base.say_until(stranger, twist(9.0), lambda: REFUSED in guard.log, "the warning")
    assert not guard.ended, guard.log
