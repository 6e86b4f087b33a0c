"""Which frames a program writes into the headers of its messages or looks up."""

import pytest
import ros1_runs
import ros2_runs
from model_cases import parameters


def stamps(interface):
    return [use.frame for use in interface.frame_uses if not use.is_look_up]


def look_ups(interface):
    return [use.frame for use in interface.frame_uses if use.is_look_up]


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


def test_the_velocity_of_an_odometry_has_a_frame():
    body = "from nav_msgs.msg import Odometry\no = Odometry()\no.child_frame_id = 'base'"
    assert python1(body) == ["base"]
    assert cpp2('nav_msgs::msg::Odometry o; o.child_frame_id = "base";') == ["base"]
    assert cpp2('geometry_msgs::msg::TransformStamped t; t.child_frame_id = "base";') == []


def test_a_callback_copies_a_frame_from_one_message_to_another():
    members = """
def tick(self):
    o = Odometry()
    o.child_frame_id = 'base'
    t = TransformStamped(child_frame_id=o.child_frame_id)
    t.header.frame_id = 'odom'
    TransformBroadcaster(self).sendTransform(t)
"""
    top = """
from nav_msgs.msg import Odometry
from geometry_msgs.msg import TransformStamped
from tf2_ros import TransformBroadcaster
"""
    found = ros2_runs.python("self.create_timer(0.1, self.tick)", top, members)
    assert [(frame.child, frame.parent) for frame in found.frames] == [("base", "odom")]


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


PYTHON = """
import tf, tf2_ros
buffer = tf2_ros.Buffer()
listener = tf2_ros.TransformListener(buffer, None)
"""


@pytest.mark.parametrize("run", [ros1_runs.python, ros2_runs.python])
@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("buffer.lookup_transform('map', 'base', time)", ["map", "base"]),
        ("buffer.lookup_transform(target_frame='map', source_frame=f(), time=t)", ["map"]),
        ("buffer.can_transform('map', unknown(), time)", ["map"]),
        ("buffer.transform(pose, 'map')", ["map"]),
        ("unknown().lookupTransform('map', 'base', time)", ["map", "base"]),
        ("listener.transformPose('map', pose)", ["map"]),
        ("model.transform(pose, 'map')", []),
        ("buffer.frames('map')", []),
    ],
)
def test_python_looks_frames_up(run, call, expected):
    assert look_ups(run(PYTHON + call)) == expected


def test_a_slash_before_a_frame_is_left_out_by_tf_of_ros_1_alone():
    calls = "l.lookupTransform('/map', 'base', t)\nl.lookup_transform('/odom', 'base', t)"
    assert look_ups(ros1_runs.python(calls)) == ["map", "base", "/odom", "base"]
    assert look_ups(ros2_runs.python("l.lookupTransform('/map', 'base', t)")) == ["/map", "base"]


def test_a_method_of_the_program_is_none_of_tf():
    body = """
class A:
    def lookup_transform(self, text):
        pass
A().lookup_transform('map')
"""
    assert look_ups(ros1_runs.python(body)) == []


CPP = """
geometry_msgs::msg::TransformStamped look() {{ return {}; }}
std::string base_; std::unique_ptr<tf2_ros::Buffer> buffer_;
"""
GIVEN = """
base_ = declare_parameter<std::string>("base", "base_link");
buffer_ = std::make_unique<tf2_ros::Buffer>(get_clock());
"""


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ('buffer_->lookupTransform("map", base_, tf2::TimePointZero)', ["map", "base_link"]),
        ('buffer_->transform(pose, "map", tf2::durationFromSec(1))', ["map"]),
        ('buffer_->setUsingDedicatedThread("map")', []),
    ],
)
def test_cpp_looks_frames_up_in_callbacks(call, expected):
    assert look_ups(ros2_runs.cpp(GIVEN, members=CPP.format(call))) == expected


def test_the_caller_may_name_the_frame():
    members = CPP.format('find("base_link")')
    members += """
geometry_msgs::msg::TransformStamped find(std::string frame) {
  return buffer_->lookupTransform("map", frame, tf2::TimePointZero); }
"""
    assert sorted(look_ups(ros2_runs.cpp(GIVEN, members=members))) == ["base_link", "map"]


def test_cpp_of_ros_1_looks_frames_up():
    body = 'tf::TransformListener l; l.lookupTransform("map", "odom", ros::Time(0), transform);'
    assert look_ups(ros1_runs.cpp(body)) == ["map", "odom"]
