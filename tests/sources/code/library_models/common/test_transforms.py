"""Which transforms a program broadcasts, in both languages of both ROS."""

import pytest
import ros1_runs
import ros2_runs
from model_cases import parameters

MESSAGE = """
{type} t;
t.header.stamp = now();
t.header.frame_id = "base";
t.child_frame_id = "laser";
t.transform.translation.x = 1;
"""
PYTHON_MESSAGE = """
t = TransformStamped()
t.header.frame_id = "base"
t.child_frame_id = "laser"
"""


def frames(interface):
    """Return what is broadcast: the child and parent frame, and what is special about it."""
    return [
        (frame.child, frame.parent)
        + ("fixed",) * frame.is_fixed
        + ("perhaps",) * (not frame.is_certain)
        for frame in interface.frames
    ]


def python1(body, **site):
    head = "import rospy, tf, tf2_ros\nfrom geometry_msgs.msg import TransformStamped\n"
    return frames(ros1_runs.python(head + body, **site))


def python2(body, **given):
    top = "from tf2_ros import *\nfrom geometry_msgs.msg import TransformStamped"
    top = top.replace("*", "TransformBroadcaster, StaticTransformBroadcaster")
    return frames(ros2_runs.python(body, top, **given))


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("tf.TransformBroadcaster().sendTransform(a, b, c, 'laser', 'base')", ("laser", "base")),
        ("tf.TransformBroadcaster().sendTransform(a, b, c, child='laser', parent='base')",
         ("laser", "base")),
        ("tf.TransformBroadcaster().sendTransform(a, b, c, 'laser', d)", ("laser", "")),
        ("tf2_ros.TransformBroadcaster().sendTransform(t)", ("laser", "base")),
        ("tf.TransformBroadcaster().sendTransformMessage(t)", ("laser", "base")),
        ("tf2_ros.StaticTransformBroadcaster().sendTransform([t])", ("laser", "base", "fixed")),
    ],
)  # fmt: skip
def test_rospy(body, expected):
    assert python1(PYTHON_MESSAGE + body) == [expected]


@pytest.mark.parametrize("name", ["d", "rospy.get_param('~frame')", "'a' + d"])
def test_a_frame_whose_name_is_not_known_is_empty(name):
    sent = f"tf.TransformBroadcaster().sendTransform(a, b, c, {name}, 'base')"
    assert python1(sent) == [("", "base")]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("tf::TransformBroadcaster b; b.sendTransform(t);", ("laser", "base")),
        ('tf::TransformBroadcaster b; b.sendTransform(tf::StampedTransform(x, y, "a", "b"));',
         ("b", "a")),
        (
            """tf::StampedTransform s; s.frame_id_ = t.header.frame_id; s.child_frame_id_ = name;
            tf::TransformBroadcaster b; b.sendTransform(s);""",
            ("own", "base"),
        ),
        (
            """std::vector<geometry_msgs::TransformStamped> v; v.push_back(t);
            tf2_ros::StaticTransformBroadcaster b; b.sendTransform(v);""",
            ("laser", "base", "fixed"),
        ),
        (
            """nav_msgs::Odometry o; o.child_frame_id = name; o.header.frame_id = name;
            t.header = o.header; t.child_frame_id = o.child_frame_id;
            tf2_ros::TransformBroadcaster b; b.sendTransform(t);""",
            ("own", "own"),
        ),
    ],
)  # fmt: skip
def test_roscpp(body, expected):
    names = 'std::string name; ros::NodeHandle own("~"); own.param<std::string>("n", name, "own");'
    message = MESSAGE.format(type="geometry_msgs::TransformStamped")
    assert frames(ros1_runs.cpp(names + message + body)) == [expected]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("TransformBroadcaster(self).sendTransform(t)", ("laser", "base")),
        ("StaticTransformBroadcaster(self).sendTransform(transform=t)", ("laser", "base", "fixed")),
    ],
)
def test_rclpy(body, expected):
    assert python2(PYTHON_MESSAGE + body) == [expected]


@pytest.mark.parametrize("static", ["", "Static"])
def test_rclcpp_in_a_callback(static):
    body = f"""b_ = std::make_unique<tf2_ros::{static}TransformBroadcaster>(*this);
    timer_ = create_wall_timer(1s, std::bind(&N::tick, this));"""
    message = MESSAGE.format(type="geometry_msgs::msg::TransformStamped")
    members = f"""void tick() {{ {message} b_->sendTransform(t); }}
    std::unique_ptr<tf2_ros::{static}TransformBroadcaster> b_; rclcpp::TimerBase::SharedPtr timer_;
    """
    expected = ("laser", "base", "fixed") if static else ("laser", "base")
    assert frames(ros2_runs.cpp(body, members=members)) == [expected]


SEND_IF = """
b = tf.TransformBroadcaster()
if {}:
    b.sendTransform(x, y, z, 'laser', 'base')
"""


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("rospy.get_param('~publish_tf', False)", []),
        ("rospy.get_param('~publish_tf', True)", [("laser", "base")]),
        ("rospy.get_param('~publish_tf')", [("laser", "base", "perhaps")]),
        ("something()", [("laser", "base")]),
    ],
)
def test_a_parameter_that_is_not_known_makes_it_uncertain(condition, expected):
    assert python1(SEND_IF.format(condition)) == expected


def test_the_launch_decides():
    given = parameters({"/ns/n/publish_tf": False})
    body = SEND_IF.format("rospy.get_param('~publish_tf', True)")
    assert python1(body, parameters=given) == []
