"""Clients of MoveIt's move_group, in both languages and both ROS."""

import pytest
from ros1_runs import cpp, python
from ros2_runs import run_text

from rtron.sources.declaration import DeclarationKind

ACTION = DeclarationKind.ACTION_CLIENT
INTERFACE = "moveit::planning_interface::MoveGroupInterface"


def actions(interface):
    """Return name and type of each action that is called."""
    return [(each.name, each.type) for each in interface.declarations if each.kind is ACTION]


def move_group(prefix):
    """Return the actions of a move_group of ROS 1 that every client is one of."""
    return [
        (f"{prefix}/move_group", "moveit_msgs/MoveGroupAction"),
        (f"{prefix}/execute_trajectory", "moveit_msgs/ExecuteTrajectoryAction"),
    ]


@pytest.mark.parametrize(
    ("body", "prefix"),
    [
        ("import moveit_commander\nmoveit_commander.MoveGroupCommander('arm').go()", "/ns"),
        ("from moveit_commander import *\ng = MoveGroupCommander('arm', ns='/robot')", "/robot"),
        ("from moveit_commander.move_group import MoveGroupCommander as M\nM('arm')", "/ns"),
        ("import moveit_commander as m\nr = m.RobotCommander()\nr.get_group('arm').go()", "/ns"),
    ],
)
def test_the_commander_of_python_is_a_client(body, prefix):
    assert actions(python(body)) == move_group(prefix)


def test_the_planning_scene_publishes():
    found = python("import moveit_commander\nmoveit_commander.PlanningSceneInterface()")
    assert [(each.name, each.implicit) for each in found.declarations] == [
        ("/ns/collision_object", False), ("/ns/attached_collision_object", False)]  # fmt: skip


@pytest.mark.parametrize(
    ("body", "prefix"),
    [
        (f'{INTERFACE} group("arm"); group.move();', "/ns"),
        ('moveit::planning_interface::MoveGroup group("arm");', "/ns"),
        (f'{INTERFACE} g({INTERFACE}::Options("a", "d", ros::NodeHandle("/robot")));', "/robot"),
        (f'auto g = std::make_shared<{INTERFACE}>("arm");', "/ns"),
    ],
)  # fmt: skip
def test_the_interface_of_roscpp_is_a_client(body, prefix):
    assert actions(cpp(body)) == move_group(prefix)


@pytest.mark.parametrize(
    ("body", "prefix"),
    [
        (f'{INTERFACE} group(node, "arm");', "/ns"),
        (f'auto group = std::make_shared<{INTERFACE}>(node, "arm");', "/ns"),
        (f'{INTERFACE} group(node, {INTERFACE}::Options("arm", "d", "robot"));', "/ns/robot"),
    ],
)
def test_the_interface_of_rclcpp_is_a_client(body, prefix):
    node = 'auto node = std::make_shared<rclcpp::Node>("n");'
    text = f"#include <rclcpp/rclcpp.hpp>\nint main(int c, char ** v) {{ {node} {body} }}"
    found = run_text(text)
    assert actions(found) == [
        (f"{prefix}/move_group", "moveit_msgs/action/MoveGroup"),
        (f"{prefix}/execute_trajectory", "moveit_msgs/action/ExecuteTrajectory"),
    ]
