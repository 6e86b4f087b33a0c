"""A program sees its own words, without those that ROS takes."""

import pytest
import ros1_runs
import ros2_runs

ROS1_WORDS = ("load", "kind:=x", "box", "__name:=n")
ROS2_WORDS = ("load", "--ros-args", "-r", "a:=b", "--", "box", "--ros-args", "-p", "c:=d")
PUBLISHING = "for (const auto & word : words) nh.advertise<std_msgs::Bool>(word, 1);"
MAIN = """#include <rclcpp/rclcpp.hpp>
int main(int argc, char ** argv) {{
  auto words = {};
  auto node = rclcpp::Node::make_shared("n");
  for (const auto & word : words) node->create_publisher<std_msgs::msg::Bool>(word, 1);
}}
"""
PYTHON = """import sys
from rclpy.utilities import remove_ros_args
for word in remove_ros_args({}):
    self.create_publisher(Bool, word, 1)
"""


def test_ros1():
    body = f"std::vector<std::string> words; ros::removeROSArgs(argc, argv, words); {PUBLISHING}"
    assert ros1_runs.names(ros1_runs.cpp(body, args=ROS1_WORDS)) == ["n", "load", "box"]


@pytest.mark.parametrize(
    "call",
    [
        "rclcpp::remove_ros_arguments(argc, argv)",
        "rclcpp::init_and_remove_ros_arguments(argc, argv)",
    ],
)
def test_rclcpp(call):
    found = ros2_runs.run_text(MAIN.format(call), args=ROS2_WORDS)
    assert ros2_runs.names(found) == ["/ns/n", "/ns/load", "/ns/box"]


@pytest.mark.parametrize("given", ["sys.argv", "args=sys.argv"])
def test_rclpy(given):
    found = ros2_runs.python(PYTHON.format(given), args=ROS2_WORDS)
    assert ros2_runs.names(found) == ["/ns/n", "/ns/load", "/ns/box"]
