"""Who speaks from an address, as the master says, and whether anybody is there."""

import socket

import pytest
from harness import free_port

from rtron.guard.audit.ros1.foreign_connections import PeerIdentity
from rtron.guard.audit.ros1.master_queries import identify_peer
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = pytest.mark.ros1
NODE, TOPIC = "/rtron/goals", "/rtron/dock/goal/out"


def identity_of(ros1, port):
    uri = f"http://127.0.0.1:{port}"
    ros_call(ros1.uri, "registerPublisher", NODE, TOPIC, "std_msgs/String", uri, timeout=10)
    return identify_peer(ros1.uri, TOPIC, uri, [NODE])


def test_a_killed_node_that_the_master_still_lists_is_refused(ros1):
    expected = PeerIdentity(name=NODE, is_refused=True, is_answered=True)
    assert identity_of(ros1, free_port()) == expected


def test_a_node_that_is_there_is_not_refused(ros1):
    with socket.create_server(("127.0.0.1", 0)) as server:
        identity = identity_of(ros1, server.getsockname()[1])
    assert identity == PeerIdentity(name=NODE, is_answered=True)
