"""`rtron verify` looks into a cell of ROS 2, and tries to get in from outside."""

import json
import subprocess
import sys

import pytest
from celled_base import needs_cell, needs_open_packages
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from celled_base2 import NODE, OUT, SHARED_MEMORY, CelledBase2, alone, ros2_in_open_folder
from ros2_harness import NODES2

from rtron.guard.audit.ros2.domain_probe import probe_shared_memory

pytestmark = [pytest.mark.ros2, needs_cell, needs_open_packages]


def verified(base):
    words = ("--plan", base.plan, "--domain", str(base.ros2.domain), "--format", "json")
    ended = base.ros2.rtron("verify", "--live", *words)
    wait_for(lambda: ended.ended, what="the verification")
    return json.loads(ended.log)


def path_of(report, node):
    (path,) = [each for each in report["paths"] if each["node"] == node]
    return path


def test_a_cell_is_closed_and_what_was_tried_in_vain_is_told():
    """Long: the probes outside of the cell look for 5 s each, and the domain is quiet for 3.5 s."""
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2)
        base.navigate()
        stranger = subprocess.Popen(["setpriv", "--reuid=4711", "--clear-groups", "sleep", "60"])
        try:
            report = verified(base)
        finally:
            stranger.kill()
            stranger.wait()
        base.wait_for_more()
    assert report["problems"] == []
    assert path_of(report, NODE) | {"reason": ""} == {
        "topic": "/cmd_vel",
        "private": OUT,
        "node": NODE,
        "state": "closed",
        "reason": "",
        "foreign": [],
    }
    memory, users = report["proven"]
    assert users.startswith(f"no process of these users gets into the cell of {NODE}: ")
    assert "4711" in users
    assert memory.startswith("by shared memory, nobody")
    assert "/nav" in [each["what"] for each in report["unguarded"]]


@pytest.mark.long
def test_what_the_user_lets_open_is_told():
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2, "--allow-shared-user", "--allow-shared-memory")
        base.navigate()
        report = verified(base)
    reasons = [each["why"] for each in report["unguarded"]]
    assert any("/dev/shm is shared" in each for each in reasons)
    assert any("the user is shared" in each for each in reasons)


@pytest.mark.long
def test_a_node_without_its_cell_is_not_closed(own_runtime_folder):
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2)
        base.navigate()
        base.cell.kill()
        assert path_of(verified(base), NODE)["state"] == "unknown"


@pytest.mark.long
def test_shared_memory_leads_into_a_network_that_has_the_machines():
    """A network of its own is no cell: the probe finds who is there."""
    with ros2_in_open_folder() as ros2:
        script = (sys.executable, NODES2 / "topic_endpoints.py", f"<{OUT}:geometry_msgs/Twist")
        node = ros2.spawn(*alone(*script), **SHARED_MEMORY)
        wait_for(lambda: "ready" in node.log, what="a node in a network of its own")
        found = probe_shared_memory(ros2.domain, [OUT])
        assert [each.node for each in found.endpoints] == ["/ends"]
