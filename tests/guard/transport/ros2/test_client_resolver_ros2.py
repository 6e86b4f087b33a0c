"""Whose a request is, in a real domain: the nameless wait a moment, and are told apart."""

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from rclpy.action import ActionClient
from ros2_world import OnRos2
from test_msgs.action import Fibonacci

from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros2.client_resolver import ClientResolver
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE

pytestmark = pytest.mark.ros2
NOBODY, NOBODY_ELSE = b"\x01\x0f" + b"\x01" * 10, b"\x01\x0f" + b"\x02" * 10


@pytest.fixture
def world(ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with OnRos2(ros2) as world:
        yield world


@pytest.fixture
def resolver(world):
    """Name the resolver of an action whose client is /one."""
    return ClientResolver("/fib", "/one", TypeInfo("t", "m"), world.transport._context)


def request_id(participant, number=0):
    """Return the id of a request: its writer's GUID and its number."""
    return participant + bytes(4) + number.to_bytes(8, "little")


def test_strangers_without_a_name_are_told_apart(world, resolver):
    peers = []
    for each in (NOBODY, NOBODY_ELSE):
        resolver.resolve(request_id(each), peers.append)
    assert peers == []
    world.until(lambda: len(peers) == 2)
    assert [peer.node for peer in peers] == [
        f"participant {each.hex()}" for each in (NOBODY, NOBODY_ELSE)
    ]
    assert not any(peer.verified for peer in peers)


def test_a_crowd_of_one_nameless_stranger_does_not_hurry_who_is_named_soon(world, resolver):
    strangers, peers = [], []
    for number in range(300):
        resolver.resolve(request_id(NOBODY, number), strangers.append)
    one = world.session.participant("/one")
    assert len(one) == PARTICIPANT_SIZE
    resolver.resolve(request_id(one), peers.append)
    assert peers == []
    client = ActionClient(world.session.node("/one"), Fibonacci, "/fib")
    world.until(lambda: peers and len(strangers) == 300)
    client.destroy()
    assert [(peer.node, peer.verified) for peer in peers] == [("/one", True)]
