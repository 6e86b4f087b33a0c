"""A crowd of a stranger's endpoints on a topic of a real domain: who is known stays known."""

from contextlib import ExitStack, closing

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from ros2_world import OnRos2

from rtron.guard.transport.ros2.participants import MAX_ENDPOINTS
from rtron.wire.ros2.interfaces import find_interface
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
TOPIC = "/words"


@pytest.fixture
def stranger(ros2, monkeypatch):
    """Be a participant of somebody else."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with closing(Ros2Session(domain=ros2.domain)) as session:
        session.node("/mallory")
        yield session


@pytest.fixture
def world(ros2, stranger):
    """Have a world whose participants come behind the stranger's by their GIDs."""
    with ExitStack() as worlds:
        first = stranger.participant("/mallory")
        while (world := worlds.enter_context(OnRos2(ros2))).session.participant("/nav") < first:
            pass
        yield world


def test_who_is_known_is_heard_whatever_crowd_comes(world, stranger):
    heard, lost = [], []

    def connect(peer):
        return heard.append if peer.node == "/nav" else None

    world.transport.subscribe("/guard", TOPIC, "std_msgs/String", connect, lost.append)
    nav = world.publisher("/nav", TOPIC)
    nav.say(world.text("before"))

    def says(word):
        nav.say(world.text(word))
        return world.text(word) in heard

    world.until(lambda: says("before"))
    cls = find_interface("std_msgs/String").cls
    for _ in range(MAX_ENDPOINTS + 50):
        stranger.node("/mallory").create_publisher(cls, TOPIC, 1)
    endpoints = world.transport.graph.endpoints
    world.until(lambda: len(endpoints(TOPIC).publishers) == MAX_ENDPOINTS)
    participants = [each.participant for each in endpoints(TOPIC).publishers]
    assert participants == sorted(participants)
    assert participants[0] == stranger.participant("/mallory")
    world.until(lambda: says("after"))
    assert lost == []
