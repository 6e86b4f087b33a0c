"""A guarded topic without a flow: its driver hears nobody."""

import pytest
from closed_topics import NODE, OUT, TOPIC, closed
from driven_base import start_guard
from harness import wait_for
from rostopic import TWIST, TopicEcho, say

pytestmark = pytest.mark.ros1
TYPE = "geometry_msgs/Twist"


def test_a_stranger_is_kept_out_where_the_plan_names_nobody_yet(ros1):
    guard = start_guard(ros1, closed(1, TYPE), NODE)
    heard = TopicEcho(ros1, "base", TOPIC, f"{TOPIC}:={OUT}")
    wait_for(lambda: ros1.connected(NODE, "/base", OUT), what="the base's connection")
    say(ros1, "stranger", TOPIC, TYPE, TWIST % 1.0, 50)
    wait_for(lambda: "unapproved" in guard.log, show=lambda: guard.log)
    assert heard.rows() == []
    assert not guard.ended, guard.log
