"""A burst of reliable data passes the guard whole; what cannot is counted and told."""

import re

import pytest
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from diagnostic_msgs.msg import DiagnosticArray
from rclpy._rclpy_pybind11 import RCLError
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy_nodes import STRING, TWIST, twist
from rmw_marks import needs_fast_dds
from ros2_plans import driving, telling, written

from rtron.vocabulary import flow_topic, output_topic

pytestmark = pytest.mark.ros2
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
COUNT = 500
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


def start_guard(ros2, plan):
    path = ros2.folder / "rtron.yaml"
    path.write_text(written(plan))
    guard = ros2.rtron("guard", "--plan", path)
    wait_for(lambda: "guarding 1 topics" in guard.log or guard.ended, what="the guard")
    return guard


def text(word):
    data = word.encode() + b"\0"
    return b"\0\1\0\0" + len(data).to_bytes(4, "little") + data


def words(heard):
    return [bytes(each)[8:].rstrip(b"\0").decode() for each in heard]


@pytest.mark.long
def test_a_burst_of_a_state_arrives_whole(ros2, stand):
    topic = "/map_part"
    guard = start_guard(ros2, telling(topic, STRING, "/reader", "mapper"))
    place = stand()
    heard = place.listener("/reader", output_topic(topic), STRING, KEEP_ALL)
    parts = place.publisher("/mapper", flow_topic(topic, "mapper"), STRING, KEEP_ALL)
    place.say_until(parts, text("hello"), lambda: heard, "the first word")
    for number in range(COUNT):
        parts.publish(text(f"part {number}"))
    place.wait_for(lambda: heard and words(heard[-1:]) == [f"part {COUNT - 1}"], "the last part")
    arrived = [word for word in words(heard) if word != "hello"]
    assert arrived == [f"part {number}" for number in range(COUNT)]
    assert "messages were lost" not in guard.log


class Counted:
    """What the guard's diagnostics count of the messages of a flow."""

    def __init__(self, place, flow):
        self._flow = flow
        self._heard = place.listener("/looker", "/diagnostics", DIAGNOSTICS)

    @property
    def values(self):
        newest = deserialize_message(bytes(self._heard[-1]), DiagnosticArray)
        return {each.key: each.value for status in newest.status for each in status.values}

    @property
    def lost(self):
        return int(self.values.get(f"lost before the guard, {self._flow}", 0)) if self._heard else 0

    @property
    def judged(self):
        counts = self.values.get(self._flow, "") if self._heard else ""
        return sum(int(n) for n in re.findall(r"(?:passed|held|dropped|modified) (\d+)", counts))


def has_taken(publisher, message):
    """Publish; tell whether the history had room: on a busy machine nothing may be taken yet."""
    try:
        publisher.publish(message)
    except RCLError:
        return False
    return True


@needs_fast_dds("without sequence numbers, what is replaced in a queue is not known")
def test_commands_that_newer_ones_replace_before_the_guard_takes_them_are_counted(ros2, stand):
    guard = start_guard(ros2, driving("nav"))
    place = stand()
    counted = Counted(place, "nav")
    speeds = place.publisher("/nav", flow_topic("/cmd_vel", "nav"), TWIST, KEEP_ALL)
    place.say_until(speeds, twist(0.5), lambda: counted.judged, "the first command")
    before, sent = counted.judged + counted.lost, 10 * COUNT
    for _ in range(sent):
        wait_for(lambda: has_taken(speeds, twist(0.5)), what="room in the publisher's history")
    place.wait_for(lambda: counted.judged + counted.lost >= before + sent, "the count of all")
    assert counted.lost
    place.wait_for(lambda: "messages were lost:" in guard.log, "the word of it")
    assert re.search(r"/cmd_vel: messages were lost: \d+ of nav, before the guard", guard.log)
