"""Ids of plugins that a tree or a goal asks a server of Nav2 for."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

TREE = """<root main_tree_to_execute="T"><BehaviorTree ID="T"><Sequence>
<ComputePathToPose goal="{{goal}}" path="{{path}}" planner_id="{}"/>
{}</Sequence></BehaviorTree></root>"""
LAUNCH = """<launch><push_ros_namespace namespace="r"/>
<node pkg="nav2_bt_navigator" exec="bt_navigator" name="bt">{tree}</node>
<node pkg="nav2_planner" exec="planner_server" name="planner">{planners}</node>
<node pkg="nav2_controller" exec="controller_server" name="control"/>
<node pkg="own" exec="client" name="client"/></launch>"""
SETUP = 'from setuptools import setup\nsetup(name="own", entry_points={"console_scripts": '
SETUP += '["client = own.client:main"]})\n'
FOLLOW = "goal.controller_id = 'FollowPath'"
CLIENT = """import rclpy
from rclpy.node import Node
from nav2_msgs.action import FollowPath
from nav2_simple_commander.robot_navigator import BasicNavigator
class Client(Node):
    def __init__(self):
        super().__init__("client")
        self.controller_id = "Mine"
        goal = FollowPath.Goal()
        {}
def main():
    rclpy.init()
    rclpy.spin(Client())
"""


@pytest.fixture
def missing(tmp_path):
    """Return what is asked for in vain: its name, its server, and what that has."""
    (tmp_path / "own").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>own</name></package>")
    (tmp_path / "setup.py").write_text(SETUP)
    (tmp_path / "own/__init__.py").touch()

    def scan(planner="Straight", inside="", goal=FOLLOW, planners="Straight", distro="iron"):
        (tmp_path / "own/client.py").write_text(CLIENT.format(goal))
        (tmp_path / "tree.xml").write_text(TREE.format(planner, inside))
        file = f'<param name="default_nav_to_pose_bt_xml" value="{tmp_path}/tree.xml"/>'
        names = f'<param name="planner_plugins" value="[{planners}]"/>' if planners else ""
        launch = tmp_path / "nav.launch.xml"
        tree = file if planner else ""
        launch.write_text(LAUNCH.format(tree=tree, planners=names))
        options = ScanOptions(workers=1, cache=None)
        graph = scan_ros2_app([tmp_path], [(launch, {})], {"ROS_DISTRO": distro}, options)
        facts = (fact for fact in graph.wiring if fact.kind == "missing_plugin")
        return [(fact.subject, fact.value, *fact.others) for fact in facts]

    return scan


def test_a_planner_that_a_tree_asks_for(missing):
    assert missing() == []
    found = [("/r/planner_id/Grid", "/r/planner", "Other", "Straight")]
    assert missing(planner="Grid", planners="Straight, Other") == found


def test_what_the_blackboard_decides_is_not_known(missing):
    assert missing(planner="{selected}") == []


def test_the_usual_tree_asks_for_the_usual_planner(missing):
    found = [("/r/planner_id/GridBased", "/r/planner", "Straight")]
    assert missing(planner="") == found
    assert missing(planner="", planners="") == []


def test_a_list_that_is_not_known_may_have_all(missing):
    assert missing(planner="Grid", planners="$(env UNKNOWN)") == []


@pytest.mark.parametrize(("distro", "count"), [("humble", 0), ("iron", 1)])
def test_the_checkers_have_ids_since_iron(missing, distro, count):
    inside = '<FollowPath path="{path}" progress_checker_id="mine"/>'
    assert len(missing(inside=inside, distro=distro)) == count


def test_a_selector_has_a_default(missing):
    found = missing(inside='<GoalCheckerSelector default_goal_checker="precise"/>')
    assert found == [("/r/goal_checker_id/precise", "/r/control", "goal_checker")]


@pytest.mark.parametrize(
    "goal",
    [
        "goal.controller_id = 'Follow'",
        "goal.controller_id = 'Fol' + 'low'",
        "BasicNavigator().followPath(None, controller_id='Follow')",
    ],
)
def test_a_controller_that_a_goal_asks_for(missing, goal):
    assert missing(goal=goal) == [("/r/controller_id/Follow", "/r/control", "FollowPath")]


@pytest.mark.parametrize(
    "goal",
    [
        "goal.controller_id = ''",
        "goal.controller_id = unknown()",
        "BasicNavigator().followPath(None, controller_id='')",
        "BasicNavigator().followPath(None, other_id='Follow')",
    ],
)
def test_a_goal_whose_id_is_empty_or_not_known(missing, goal):
    assert missing(goal=goal) == []
