"""What the code of packages tells."""

from collections import Counter

import pytest

from rtron.functions.repository import SourcePackage
from rtron.functions.rules.code_rules import load_code_rules, match_code, package_facts
from rtron.vocabulary import FunctionType

T = FunctionType
KINDS = {"depends", "exports", "uses", "publishes", "subscribes", "launches"}
KINDS |= {"plugs", "includes", "imports", "ships", "builds"}


def types(*facts, of_repository=False):
    found = match_code(frozenset(facts), of_repository=of_repository)
    return {match.rule.type for match in found}


@pytest.mark.parametrize(
    ("facts", "type"),
    [
        (["exports rqt_gui"], T.VISUALIZATION),
        (["exports nav2_core"], T.PATH_PLANNING),
        (["exports controller_interface"], T.PATH_TRACKING),
        (["exports nav2_costmap_2d"], T.MAPPING),
        (["plugs rviz_common::Panel"], T.VISUALIZATION),
        (["plugs kinematics::KinematicsBase"], T.PATH_PLANNING),
        (["plugs controller_interface::ControllerInterface"], T.PATH_TRACKING),
        (["plugs rosbag2_storage::MessageDefinitionSource"], T.EXTENSION),
        (["ships models", "ships settings"], T.VISUALIZATION),
        (["imports speech_recognition"], T.RECOGNITION),
        (["imports smbus2"], T.SENSORS),
        (["imports py_trees"], T.GOAL_PLANNER),
        (["includes modbus.h"], T.SUPPORT),
        (["builds elsewhere"], T.EXTENSION),
        (["depends smach_ros"], T.GOAL_PLANNER),
        (["depends camera_info_manager"], T.SENSORS),
        (["depends rosbridge_library"], T.SUPPORT),
        (["depends espeak"], T.SPEECH_GENERATION),
        (["depends sound_play"], T.SPEAKER),
        (["depends python3_serial", "depends sensor_msgs"], T.SENSORS),
        (["depends industrial_robot_client"], T.MANIPULATOR),
        (["depends rosidl_default_generators"], T.EXTENSION),
        (["publishes vision_msgs/Detection2DArray"], T.RECOGNITION),
        (["publishes my_things/ObjectDetections"], T.RECOGNITION),
        (["subscribes geometry_msgs/Twist", "publishes nav_msgs/Odometry"], T.MOBILE),
        (["subscribes sensor_msgs/Joy", "publishes geometry_msgs/TwistStamped"], T.TELEOPERATION),
        (
            ["subscribes sensor_msgs/Imu", "publishes geometry_msgs/PoseWithCovarianceStamped"],
            T.LOCALIZATION,
        ),
        (["subscribes sensor_msgs/LaserScan", "publishes nav_msgs/OccupancyGrid"], T.MAPPING),
        (["subscribes sensor_msgs/Image", "publishes sensor_msgs/PointCloud2"], T.PREPROCESSING),
    ],
)
def test_facts_tell_a_type(facts, type):
    assert types(*facts) == {type}


def test_one_of_each_line_is_needed():
    assert types("subscribes sensor_msgs/Joy") == set()
    assert types("publishes nav_msgs/Odometry") == set()


def test_what_a_package_must_be_without():
    assert types("depends joy") == {T.TELEOPERATION}
    assert T.TELEOPERATION not in types("depends joy", "depends gazebo_ros")


def test_an_alternative_may_be_of_another_kind():
    (rule,) = (rule for rule in load_code_rules() if rule.id == "code-reads-joystick")
    imported = ["imports pygame", "imports evdev", "imports inputs", "imports pynput"]
    assert rule.has == (("includes linux/joystick.h", *imported),)


def test_a_match_names_the_facts():
    facts = frozenset({"subscribes sensor_msgs/Joy", "publishes geometry_msgs/Twist", "depends x"})
    (match,) = match_code(facts)
    assert match.rule.id == "code-joystick-drives"
    assert match.text == "subscribes sensor_msgs/Joy, publishes geometry_msgs/Twist"


def test_that_nothing_of_a_robot_is_there_is_asked_of_the_whole_repository():
    assert types("depends rclcpp") == set()
    assert types("depends rclcpp", of_repository=True) == {T.EXTENSION}
    assert types("depends rclcpp", "depends sensor_msgs", of_repository=True) == set()
    assert types(of_repository=True) == set()


def test_the_facts_of_a_package_are_its_dependencies_and_its_code():
    code = frozenset({"exports rviz"})
    package = SourcePackage(name="a", depends=("joy", "python3-serial"), code=code)
    assert package_facts(package) == {"depends joy", "depends python3_serial", "exports rviz"}


def test_every_rule_has_its_own_name_a_weight_and_known_kinds():
    rules = load_code_rules()
    assert max(Counter(rule.id for rule in rules).values()) == 1
    for rule in rules:
        assert rule.id.startswith("code-")
        assert 1 <= rule.weight <= 9
        patterns = [pattern for group in (*rule.has, *rule.without) for pattern in group]
        assert {pattern.partition(" ")[0] for pattern in patterns} <= KINDS, rule.id
        assert all(len(pattern.split()) == 2 for pattern in patterns), rule.id
