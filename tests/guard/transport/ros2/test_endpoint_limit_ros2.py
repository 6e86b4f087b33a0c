"""A crowd of a stranger's endpoints on a topic of a real domain: who is known stays known."""

import subprocess

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from harness import wait_for
from rmw_marks import RMW
from ros2_world import OnRos2

from rtron.guard.transport.common.protocol import InputOptions
from rtron.guard.transport.ros2.participants import MAX_ENDPOINTS

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
TOPIC, TYPE = "/words", "std_msgs/UInt8MultiArray"
FIRST_GIDS, LAST_GIDS = range(64), range(128, 192)
"""Lowest bytes of process ids: the first that differ in the GIDs of Fast DDS."""


@pytest.fixture
def world(ros2):
    with OnRos2(ros2) as world:
        yield world


def skip_process_ids(wanted):
    """Start processes until the lowest byte of their id is wanted, for the next one's, too."""

    def is_wanted():
        with subprocess.Popen(["true"]) as process:
            return process.pid % 256 in wanted

    wait_for(is_wanted, what="a process id")


@pytest.mark.long
def test_who_is_known_is_heard_whatever_crowd_comes(world, ros2):
    """Each in a process: two participants of one process may never learn of each other."""
    heard, lost = [], []

    def connect(peer):
        return heard.append if peer.node == "/nav" else None

    world.transport.subscribe("/guard", TOPIC, TYPE, connect, InputOptions(on_lost=lost.append))
    skip_process_ids(LAST_GIDS)
    ros2.node("bytes_publisher.py", TOPIC, "8", "1", name="/nav")
    world.until(lambda: heard)
    skip_process_ids(FIRST_GIDS)
    ros2.node("node_group.py", "/mallory", *[f">{TOPIC}:{TYPE}"] * (MAX_ENDPOINTS + 50))
    nodes = []

    def is_crowded():
        nodes[:] = (each.node for each in world.transport.graph.endpoints(TOPIC).publishers)
        return nodes.count("/mallory") == MAX_ENDPOINTS - 1

    world.until(is_crowded)
    assert nodes.count("/nav") == 1
    assert nodes[-1] == "/nav" or not RMW.startswith("rmw_fastrtps")
    heard.clear()
    world.until(lambda: heard)
    assert lost == []
