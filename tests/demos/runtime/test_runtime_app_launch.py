"""What a launch file of ROS 2 starts, as the command lines that launch_ros would make of it."""

from itertools import pairwise
from pathlib import Path

import pytest

from rtron.demos.runtime.app_launch import node_commands, node_names
from rtron.demos.runtime.isolation import first_party_packages, launch_file, third_party_packages
from rtron.errors import InputError
from rtron.planning.instrument import instrument_ros2, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.plan_file.loader import parse_plan
from rtron.sources.launch.ros2.reader import read_ros2_launch

PYTHON = Path("/python")
PLAN = """
app: demo
ros: 2
grcn:
  - topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Preemption
    flows:
      - {name: nav, publisher: /move_base, priority: 2}
      - {name: other, publisher: /tb3_safe_control, priority: 1}
    successors: [/turtlebot3_core]
"""
FOLDERS = (first_party_packages(2), third_party_packages(2))
PACKAGES = {
    "tb3_demo": first_party_packages(2) / "tb3_demo",
    "tb3_monitor": third_party_packages(2) / "tb3_monitor",
    "tb3_safe_control": third_party_packages(2) / "tb3_safe_control",
}


def rules(command):
    return [rule for word, rule in pairwise(command) if word == "-r"]


def test_the_app_is_the_same_on_both():
    first = node_names(launch_file(1), (first_party_packages(1), third_party_packages(1)), {})
    second = node_commands(launch_file(2), FOLDERS, {}, PYTHON)
    assert {each.node for each in second} == first
    assert all(Path(each.command[1]).is_file() for each in second)


def test_the_guarded_launch_starts_the_guard_and_remaps_who_is_guarded(tmp_path):
    tree = read_ros2_launch(launch_file(2), {}, {}, PACKAGES)
    out = tmp_path / "guarded.launch.xml"
    write_guarded_launch(instrument_ros2(tree, parse_plan(PLAN), out, GuardFiles(PLAN)))
    guard, *nodes = node_commands(out, FOLDERS, {}, PYTHON)
    assert not guard.is_of_app
    assert guard.command == (str(tmp_path / "guarded.launch.d" / "guard"),)
    remapped = {each.node: rules(each.command)[2:] for each in nodes if each.is_of_app}
    assert {node: found for node, found in remapped.items() if found} == {
        "/move_base": ["/cmd_vel:=/rtron/cmd_vel/nav"],
        "/tb3_safe_control": ["/cmd_vel:=/rtron/cmd_vel/other"],
        "/turtlebot3_core": ["/cmd_vel:=/rtron/cmd_vel/out"],
    }


def test_a_name_a_namespace_arguments_and_remaps(tmp_path):
    launch = tmp_path / "app.launch.xml"
    launch.write_text(
        '<launch><push_ros_namespace namespace="robot"/>'
        '<node pkg="tb3_demo" exec="lds" name="eyes" args="--far \'2 m\'">'
        '<remap from="scan" to="/near"/></node></launch>'
    )
    (lidar,) = node_commands(launch, FOLDERS, {}, PYTHON)
    assert lidar.node == "/robot/eyes"
    assert lidar.command == (
        *("/python", str(PACKAGES["tb3_demo"] / "scripts" / "lds"), "--far", "2 m", "--ros-args"),
        *("-r", "__node:=eyes", "-r", "__ns:=/robot", "-r", "scan:=/near"),
    )


def test_a_package_that_is_not_there(tmp_path):
    launch = tmp_path / "app.launch.xml"
    launch.write_text('<launch><node pkg="nowhere" exec="x" name="x"/></launch>')
    with pytest.raises(InputError, match="/x: there is no package 'nowhere'"):
        node_commands(launch, FOLDERS, {}, PYTHON)
