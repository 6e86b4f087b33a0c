"""Programs that use the other ROS than their launch: a note says so, with the place."""

import pytest
import ros1_runs
import ros2_runs

ROSPY = """import rospy
from std_msgs.msg import Bool
def main():
    rospy.init_node("n")
    rospy.Publisher("out", Bool)
main()
"""
ROSCPP = """#include <ros/ros.h>
#include <std_msgs/Bool.h>
int main(int argc, char ** argv) {
  ros::init(argc, argv, "n");
  ros::NodeHandle nh;
  ros::Publisher p = nh.advertise<std_msgs::Bool>("out", 1);
}
"""
RCLPY = "import rclpy\nfrom rclpy.node import Node\nrclpy.init()\nNode('n').create_client(T, 'x')\n"
RCLCPP = """#include <rclcpp/rclcpp.hpp>
int main(int argc, char ** argv) {
  rclcpp::init(argc, argv);
  auto n = std::make_shared<rclcpp::Node>("n");
}
"""


def notes(interface):
    found = [note for note in interface.unresolved if "it is of ROS" in note.why]
    return [(note.what, note.evidence[0].line) for note in found]


@pytest.mark.parametrize(
    ("text", "suffix", "expected"),
    [
        (ROSPY, "py", [("import rospy", 1)]),
        (ROSCPP, "cpp", [("ros::init", 4), ("ros::NodeHandle", 5)]),
    ],
)
def test_ros1_in_a_launch_of_ros2(text, suffix, expected):
    assert notes(ros2_runs.run_text(text, suffix)) == expected
    assert not notes(ros1_runs.run_text(text, suffix))


@pytest.mark.parametrize(
    ("text", "suffix", "expected"),
    [
        (RCLPY, "py", [("import rclpy", 1), ("import rclpy", 2)]),
        (RCLCPP, "cpp", [("rclcpp::init", 3), ("rclcpp::Node", 4)]),
    ],
)
def test_ros2_in_a_launch_of_ros1(text, suffix, expected):
    assert notes(ros1_runs.run_text(text, suffix)) == expected
    assert not notes(ros2_runs.run_text(text, suffix))


@pytest.mark.parametrize("runs", [ros1_runs, ros2_runs])
def test_a_program_that_asks_which_ros_it_is_in_uses_the_right_one(runs):
    choice = "if os.environ['ROS_VERSION'] == '1':\n    import rospy\nelse:\n    import rclpy\n"
    assert not notes(runs.run_text(f"import os\n{choice}", "py"))
