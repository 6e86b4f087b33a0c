"""What the guard's transport on ROS 2 loses of a burst, and what it says about it."""

import signal
import sys
from pathlib import Path

import pytest

from rtron.vocabulary import QoS

pytest.importorskip("rclpy", reason="needs ROS 2")
from rmw_marks import needs_fast_dds
from ros2_harness import NODES2

from rtron.guard.transport.common.protocol import InputOptions
from rtron.guard.transport.ros2 import middleware, publication
from rtron.guard.transport.ros2.delivery import LatenessDetector
from rtron.guard.transport.ros2.publication import LosslessWriter

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
    pytest.mark.filterwarnings("ignore:Deprecated in favor of:DeprecationWarning"),
    pytest.mark.parametrize("world", ["ros2"], indirect=True),
]
NODE, TOPIC, STRING, TWIST = "/rtron/a", "/burst", "std_msgs/String", "geometry_msgs/Twist"
COUNT, QUEUE = 300, 20
NEEDS_NUMBERS = needs_fast_dds("without sequence numbers, what is replaced in a queue is not known")
IMAGE, PICTURE_BYTES = "sensor_msgs/Image", 1 << 22


class Reader:
    """Takes one publisher's messages, and knows of those that were lost."""

    def __init__(self, world, **options):
        self.heard, self.lost, self.is_connected = [], 0, False
        given = InputOptions(on_missed=self._miss, queue_size=QUEUE, **options)
        world.transport.subscribe(NODE, TOPIC, STRING, self._connect, options=given)

    def _connect(self, _peer):
        self.is_connected = True
        return self.heard.append

    def _miss(self, peer, count):
        assert peer.node == "/talker"
        self.lost += count


def burst(world, reader):
    """Let a publisher say much while the guard does not listen; return what it said."""
    talker = world.publisher("/talker", TOPIC)
    world.until(lambda: reader.is_connected and talker.readers)
    said = [world.text(f"{number}") for number in range(COUNT)]
    for word in said:
        talker.say(word)
    return said


def test_all_of_a_burst_waits_where_all_is_kept(world):
    reader = Reader(world, keep_all=True)
    said = burst(world, reader)
    world.until(lambda: reader.heard[-1:] == said[-1:])
    assert (reader.heard, reader.lost) == (said, 0)


@NEEDS_NUMBERS
@pytest.mark.parametrize("options", [{}, {"keep_all": True, "is_command": lambda _peer: True}])
def test_what_a_queue_has_no_room_for_is_counted_to_the_last_message(world, options):
    reader = Reader(world, **options)
    said = burst(world, reader)
    world.until(lambda: len(reader.heard) + reader.lost == COUNT)
    assert reader.heard[-1] == said[-1]
    assert reader.lost


@NEEDS_NUMBERS
def test_what_comes_late_counts_although_nothing_follows_it(world, monkeypatch):
    taken = []
    monkeypatch.setattr(
        LatenessDetector, "is_late", lambda *_: taken.append(1) or len(taken) > QUEUE // 2
    )
    reader = Reader(world, is_command=lambda _peer: True)
    burst(world, reader)
    world.until(lambda: len(reader.heard) + reader.lost == COUNT)
    assert len(reader.heard) == QUEUE // 2


def test_what_a_subscriber_is_too_slow_for_is_counted_and_the_guard_does_not_wait(
    world, ros2, monkeypatch
):
    monkeypatch.setattr(middleware, "publishes_without_waiting", lambda _rmw: True)
    monkeypatch.setattr(publication, "MAX_BYTES", 1000)
    output = world.transport.advertise(NODE, TOPIC, TWIST, keep_all=True)
    output.learn_type(world.info(TWIST))
    output.offer("one", QoS())
    slow = ros2.node("twist_subscriber.py", TOPIC, name="/slow")
    world.until(lambda: output.is_subscribed_by("/slow"))
    twist = b"\0\1\0\0" + bytes(48)
    slow.tell(signal.SIGSTOP)
    for _ in range(COUNT):
        output.publish(twist)
    assert 0 < output.lost < COUNT
    slow.tell(signal.SIGCONT)

    def is_sent():
        before = output.lost
        output.publish(twist)
        return output.lost == before

    world.until(is_sent)
    lost = output.lost
    output.close()
    assert output.lost == lost


def test_what_a_frozen_subscriber_does_not_take_fills_no_memory(world, ros2):
    output = world.transport.advertise(NODE, TOPIC, IMAGE)
    output.learn_type(world.info(IMAGE))
    output.offer("one", QoS())
    slow = ros2.spawn(sys.executable, NODES2 / "node_group.py", "/slow", f"<{TOPIC}:{IMAGE}")
    world.until(lambda: output.is_subscribed_by("/slow"))
    slow.tell(signal.SIGSTOP)
    picture = b"\0\1\0\0" + bytes(PICTURE_BYTES)
    before = memory_bytes()
    for _ in range(40):
        output.publish(picture)
    slow.tell(signal.SIGCONT)
    assert memory_bytes() - before < 20 * PICTURE_BYTES


def memory_bytes():
    """Return how much memory of its own this process has."""
    fields = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
    return 1024 * int(fields["RssAnon"].split()[0])


def test_only_reliable_states_of_common_size_are_kept(world, monkeypatch):
    monkeypatch.setattr(middleware, "publishes_without_waiting", lambda _rmw: True)

    def writer(type, **options):
        output = world.transport.advertise(NODE, f"/t{len(made)}", type, **options)
        made.append(output)
        output.offer("one", QoS())
        return output._writer

    made = []
    assert isinstance(writer(STRING, keep_all=True), LosslessWriter)
    assert not isinstance(writer(STRING), LosslessWriter)
    assert not isinstance(writer("sensor_msgs/Image", keep_all=True), LosslessWriter)
    monkeypatch.setattr(middleware, "publishes_without_waiting", lambda _rmw: False)
    assert not isinstance(writer(STRING, keep_all=True), LosslessWriter)
