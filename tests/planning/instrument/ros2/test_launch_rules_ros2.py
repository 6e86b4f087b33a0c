"""The rules that a guarded Python launch file gives, resolved by a real rcl.

What launch would start comes from the double of launch and launch_ros.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
pytestmark = pytest.mark.ros2

from wrapped_launch import HEAD, launch  # noqa: E402

from rtron.planning.instrument.ros2.wrapper import wrapper_text  # noqa: E402

RESOLVED = Path(__file__).parents[3] / "ros2" / "nodes" / "name_resolver.py"
PRIVATE = "/rtron/cmd_vel/teleop"
GOALS = "/rtron/go/teleop/_action/send_goal"
TABLE = {
    "/a/teleop": {"/cmd_vel": PRIVATE, "/go/_action/send_goal": GOALS},
    "/b/teleop": {"/cmd_vel": "/rtron/cmd_vel/other"},
    "/base": {"/cmd_vel": "/rtron/cmd_vel/out"},
}


def resolved(*arguments):
    """Return what names of the node resolve to in a process of those arguments."""
    command = [sys.executable, RESOLVED, *arguments]
    ran = subprocess.run(command, capture_output=True, text=True, check=False, timeout=90)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout.splitlines()[-1])


@pytest.fixture
def launched(tmp_path):
    def run(body):
        app, out = tmp_path / "app.launch.py", tmp_path / "guarded.launch.py"
        app.write_text(HEAD.format(body))
        out.write_text(wrapper_text(str(app), TABLE))
        return launch(out)

    return run


def test_a_process_under_a_set_remap_and_rules_of_its_own(launched):
    node = (
        "Node(package='p', executable='e', name='teleop', namespace='a', "
        "remappings=[('~/out', '/cmd_vel'), ('out', '/elsewhere')])"
    )
    [command] = launched(f"SetRemap('out', '/cmd_vel'), {node}")["started"]
    found = resolved(*command[1:])
    assert found == {"out": PRIVATE, "/cmd_vel": PRIVATE, "~/out": PRIVATE, "client": [GOALS]}


def test_a_component(launched):
    node = (
        "ComposableNode(package='p', plugin='P', name='teleop', namespace='/a', "
        "remappings=[('out', '/cmd_vel')])"
    )
    load = f"LoadComposableNodes(target_container='/x', composable_node_descriptions=[{node}])"
    [loaded] = launched(load)["loaded"]
    named = (f"__node:={loaded['name']}", f"__ns:={loaded['namespace']}")
    found = resolved("--component", *loaded["rules"], *named)
    expected = {"out": PRIVATE, "/cmd_vel": PRIVATE, "~/out": "/a/teleop/out", "client": [GOALS]}
    assert found == expected
