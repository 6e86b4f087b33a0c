"""A command that leaves the launch: the base, started apart, hears the app through the guard."""

import os
import signal

import pytest
from driven_base import start_guard
from harness import wait_for
from leaving_topics import INPUT, LAST_NODE, NODE, REFUSED, TOPIC, leaving
from rostopic import TWIST, TopicEcho, say

from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

pytestmark = pytest.mark.ros1
TYPE = "geometry_msgs/Twist"


@pytest.mark.parametrize("bystanders", [(), ("/bystander",)])
def test_a_base_apart_hears_the_app_through_the_guard_and_a_stranger_beside_it(ros1, bystanders):
    guard = start_guard(ros1, leaving(1, TYPE, *bystanders), NODE)
    base = TopicEcho(ros1, "base", TOPIC)
    say(ros1, "nav", TOPIC, TYPE, TWIST % 0.5, 50, f"{TOPIC}:={INPUT}")
    base.wait_for(lambda rows: [0.5, 0, 0, 0, 0, 0] in rows, "the app's command")
    assert ros1.publishers(TOPIC) == {LAST_NODE, SUPERVISOR_NODE}
    say(ros1, "stranger", TOPIC, TYPE, TWIST % 9.0, 50)
    base.wait_for(lambda rows: [9, 0, 0, 0, 0, 0] in rows, "the stranger's command")
    wait_for(lambda: REFUSED in guard.log, show=lambda: guard.log)
    assert not guard.ended, guard.log


@pytest.mark.parametrize("bystanders", [(), ("/bystander",)])
def test_when_the_guard_dies_the_supervisor_stops_a_base_apart(ros1, bystanders):
    guard = start_guard(ros1, leaving(1, TYPE, *bystanders), NODE)
    base = TopicEcho(ros1, "base", TOPIC)
    say(ros1, "nav", TOPIC, TYPE, TWIST % 0.5, 50, f"{TOPIC}:={INPUT}")
    base.wait_for(lambda rows: [0.5, 0, 0, 0, 0, 0] in rows, "the app's command")
    wait_for(lambda: ros1.connected(SUPERVISOR_NODE, "/base", TOPIC), what="the supervisor")
    assert "unapproved publisher" not in guard.log
    os.kill(ros1.ask(ros1.uri_of(GUARD_NODE), "getPid"), signal.SIGKILL)
    base.wait_for(lambda rows: any(row[0] < 0.5 for row in rows), "the stop")
