"""Which frames a program writes into the headers of its messages, in both languages."""

import pytest
import ros1_runs
import ros2_runs
from model_cases import parameters


def stamps(interface):
    return [stamp.frame for stamp in interface.stamps]


def python1(body, **site):
    head = "import rospy\nfrom sensor_msgs.msg import LaserScan\nscan = LaserScan()\n"
    return stamps(ros1_runs.python(head + body, **site))


def cpp2(body, members=""):
    return stamps(ros2_runs.cpp(body, members=members))


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("'laser'", ["laser"]),
        ("rospy.get_param('~frame', 'laser') + '_1'", ["laser_1"]),
        ("rospy.get_param('~frame')", []),
        ("unknown()", []),
        ("7", []),
    ],
)
def test_a_frame_that_is_known(value, expected):
    assert python1(f"scan.header.frame_id = {value}") == expected


def test_the_launch_gives_its_value():
    given = parameters({"/ns/n/frame": "pico"})
    body = "scan.header.frame_id = rospy.get_param('~frame', 'laser') + '_1'"
    assert python1(body, parameters=given) == ["pico_1"]


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        ("scan.header.frame_id", ["laser"]),
        ("header.frame_id", ["laser"]),
        ("unknown().header.frame_id", ["laser"]),
        ("unknown().frame_id", []),
        ("scan.frame_id", []),
        ("scan.header.stamp", []),
        ("frame_id", []),
    ],
)
def test_only_a_header_has_the_frame_of_a_message(target, expected):
    assert python1(f"header = scan.header\n{target} = 'laser'") == expected


def test_a_parameter_that_is_not_known_decides_on_nothing():
    body = "if rospy.get_param('~stamp'):\n    scan.header.frame_id = 'laser'"
    assert python1(body) == []


def test_the_frame_of_a_transform_is_its_parent():
    body = """
from geometry_msgs.msg import TransformStamped
t = TransformStamped()
t.header.frame_id = 'base'
"""
    assert python1(body) == []
    assert cpp2('geometry_msgs::msg::TransformStamped t; t.header.frame_id = "base";') == []


TICK = """
void tick() {{ sensor_msgs::msg::LaserScan scan; scan.header.frame_id = {}; pub_->publish(scan); }}
std::string frame_; rclcpp::TimerBase::SharedPtr timer_;
"""
TIMER = 'frame_ = declare_parameter<std::string>("frame", "laser");'


@pytest.mark.parametrize("value", ['"laser"', "frame_"])
def test_a_callback_that_joins_no_nodes_is_looked_at(value):
    timer = f"{TIMER} timer_ = create_wall_timer(1s, std::bind(&N::tick, this));"
    assert cpp2(timer, TICK.format(value)) == ["laser"]
    assert cpp2(TIMER, TICK.format(value)) == ["laser"]
    body = """
frame = 'laser'
def tick(event):
    scan.header.frame_id = frame
rospy.Timer(rospy.Duration(1), tick)
"""
    assert python1(body) == ["laser"]


def test_what_such_a_callback_declares_does_not_count():
    members = TICK.format('"laser"').replace("pub_->", 'other_ = unknown("a"); pub_->')
    found = ros2_runs.cpp("", members=members)
    assert stamps(found) == ["laser"]
    assert not [each for each in found.declarations if not each.implicit]
