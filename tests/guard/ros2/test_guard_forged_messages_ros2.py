"""The guard on a real ROS 2 among strangers who go past rcl: with names that are none, and lies."""

import re
from contextlib import closing

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from forged_writer import Forger, another_version
from rclpy_nodes import TWIST, twist
from rmw_marks import RMW
from ros2_plans import driving, written

from rtron.vocabulary import OnSilence, flow_topic, output_topic
from rtron.wire.ros2.endpoints import publishers_of
from rtron.wire.ros2.interfaces import find_interface

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
PLAN = written(driving("nav", "teleop", on_silence=OnSilence.RELEASE))
NAV, TELEOP = flow_topic("/cmd_vel", "nav"), flow_topic("/cmd_vel", "teleop")
OUT = output_topic("/cmd_vel")
NO_UTF8 = b"\xff\xfe\xc3("


@pytest.fixture
def guard(ros2):
    """Have the guard; it lives to the end."""
    plan = ros2.folder / "rtron.yaml"
    plan.write_text(PLAN)
    guard = ros2.rtron("guard", "--plan", plan)
    wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
    yield guard
    assert not guard.ended, guard.log
    assert "internal error" not in guard.log
    assert guard.log.count("the guard begins") == 1, guard.log


def names(node):
    return {each.node for each in publishers_of(node, NAV)}


def test_names_that_cannot_be_read_do_not_blind_the_guard(guard, stand):
    app, stranger = stand(), stand()
    driver = app.listener("/driver", OUT)
    nav = app.publisher("/nav", NAV)
    app.say_until(nav, twist(0.5), lambda: driver, "the navigation")
    stranger.publisher("/evil", NAV)
    with closing(Forger(stranger.node("/evil"))) as forger:
        if RMW.startswith("rmw_fastrtps"):  # Cyclone DDS makes no topic of such a name
            forger.publisher(find_interface(TWIST).cls, b"rt/" + NO_UTF8)
        lie = forger.calls("/evil", NO_UTF8, NAV)
        seen = r"unapproved publisher /.+\( on the private topic of nav"
        app.wait_for(lambda: lie() or re.search(seen, guard.log), "the event")
        app.say_until(nav, twist(0.125), lambda: twist(0.125) in driver, "the navigation after it")
        late = app.publisher("/nav", NAV)
        app.say_until(late, twist(0.75), lambda: twist(0.75) in driver, "who has come after it")


def test_a_publisher_is_heard_whatever_a_stranger_calls_it(guard, stand):
    app, stranger = stand(), stand()
    driver = app.listener("/driver", OUT)
    nav = app.publisher("/nav", NAV)
    app.say_until(nav, twist(0.5), lambda: driver, "the navigation")
    with closing(Forger(stranger.node("/evil"))) as forger:
        truth = forger.calls("/nav", b"nav", NAV, b"driver")
        lie = forger.calls("/nav", b"other", NAV)
        app.wait_for(lambda: lie() or "foreign publisher: /other of the" in guard.log, "the event")
        app.say_until(nav, twist(0.125), lambda: twist(0.125) in driver, "the navigation after it")
        # With Cyclone DDS who is told that a node of his own is not there crashes as he ends it.
        app.wait_for(lambda: truth() or "/nav" in names(app.node("/nav")), "the truth")
    assert "unapproved publisher" not in guard.log


@pytest.mark.long
def test_a_publisher_of_another_version_of_the_type_is_refused(guard, stand):
    app, elsewhere = stand(), stand()
    driver = app.listener("/driver", OUT)
    with another_version(find_interface(TWIST).cls):
        nav = elsewhere.publisher("/nav", NAV)
    told = f"{NAV}: /nav is ignored: its geometry_msgs/msg/Twist is another version"
    elsewhere.say_until(nav, twist(9.0), lambda: told in guard.log, "the event")
    teleop = app.publisher("/teleop", TELEOP)
    app.say_until(teleop, twist(0.5), lambda: twist(0.5) in driver, "the teleoperation")
    nav.publish(twist(9.0))
    app.say_until(teleop, twist(0.25), lambda: twist(0.25) in driver, "the teleoperation after it")
    assert twist(9.0) not in driver
