"""A guarded launch of ROS 2 whose driver runs in a cell, as launch starts it.

Where `launch_ros` is missing, as in the wheels, the commands that its double says it would start.
"""

import importlib.util
import json
import sys

import pytest
from celled_base import needs_cell, needs_open_packages, open_file
from harness import wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from celled_base2 import (
    DRIVEN,
    NODE,
    OUT,
    PLAN,
    CelledBase2,
    copy_base,
    python_for_others,
    ros2_in_open_folder,
)
from ros2_harness import NODES2
from ros2_plans import driving, written
from wrapped_launch import launch

from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import Direction, Endpoint, InteractionGraph

pytestmark = [pytest.mark.long, pytest.mark.ros2, needs_cell, needs_open_packages]
TWIST = "geometry_msgs/msg/Twist"
GRAPH = InteractionGraph(
    app="robot",
    ros=2,
    endpoints=(
        Endpoint(node="/nav", topic="/cmd_vel", direction=Direction.PUBLISH, type=TWIST),
        Endpoint(node=NODE, topic="/cmd_vel", direction=Direction.SUBSCRIBE, type=TWIST),
    ),
)
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    commands = {commands!r}
    return LaunchDescription(
        [
            Node(executable=first, arguments=words, name=name, output="screen")
            for name, (first, *words) in commands.items()
        ]
    )
"""
RUN = """import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

service = LaunchService()
included = IncludeLaunchDescription(PythonLaunchDescriptionSource(sys.argv[1]))
service.include_launch_description(LaunchDescription([included]))
sys.exit(service.run())
"""


def start_with_launch(ros2, out):
    run = ros2.folder / "run.py"
    run.write_text(RUN)
    ros2.spawn(sys.executable, run, out)


def start_as_launch_would(ros2, out):
    launched = launch(out)
    assert launched["error"] == ""
    for command in launched["started"]:
        ros2.spawn(*command)


class LaunchedBase2(CelledBase2):
    """The driven base, all of which a guarded launch starts."""

    def __init__(self, ros2, start):
        self.ros2, self._file = ros2, open_file(ros2.folder / DRIVEN)
        self.plan = ros2.folder / "guarded.launch.d" / PLAN
        start(ros2, self._instrument())
        wait_for(lambda: len(self.navigation()) > 5, what="navigation at the driver")

    def _instrument(self):
        """Write the guarded launch with the driver in a cell; return its file."""
        folder = self.ros2.folder
        app, plan, graph = (folder / name for name in ("app.launch.py", PLAN, "graph.json"))
        out = folder / "guarded.launch.py"
        commands = {
            "driver": (*python_for_others(), copy_base(folder), folder / DRIVEN, "/cmd_vel"),
            "nav": (sys.executable, NODES2 / "slow_navigation.py", "/cmd_vel", "50"),
        }
        words = {name: [str(word) for word in command] for name, command in commands.items()}
        app.write_text(LAUNCH.format(commands=words))
        plan.write_text(written(driving("nav")))
        graph.write_text(json.dumps(graph_to_json(GRAPH)))
        files = ("--plan", plan, "--graph", graph, "-o", out)
        written_launch = self.ros2.rtron("instrument", app, *files, "--cell", NODE)
        wait_for(lambda: written_launch.ended, what="rtron instrument")
        assert f"{NODE} runs in a cell" in written_launch.log
        return out


has_launch = importlib.util.find_spec("launch_ros")


@pytest.mark.parametrize(
    "start",
    [
        pytest.param(
            start_with_launch,
            marks=pytest.mark.skipif(not has_launch, reason="launch_ros is not in the wheels"),
        ),
        start_as_launch_would,
    ],
)
def test_a_guarded_launch_starts_the_driver_in_its_cell(start):
    with ros2_in_open_folder() as ros2:
        base = LaunchedBase2(ros2, start)
        words = ("--plan", base.plan, "--domain", str(ros2.domain))
        verified = ros2.rtron("verify", "--live", *words)
        wait_for(lambda: verified.ended, what="the verification")
        assert verified.code == 0, verified.log
        since = len(base.messages())
        base.intrude(OUT)
        base.assert_undisturbed(since, more=100)
