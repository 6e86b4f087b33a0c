"""Message types as C++ names them."""

import pytest
import ros1_runs
import ros2_runs

from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.message_types import cpp_message_type, message_header


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("std_msgs::String", "std_msgs/String"),
        ("std_msgs::String::ConstPtr", "std_msgs/String"),
        ("std_msgs::StringConstPtr", "std_msgs/String"),
        ("std_msgs::msg::String", "std_msgs/msg/String"),
        ("std_msgs::msg::String::SharedPtr", "std_msgs/msg/String"),
        ("std_msgs::msg::String::ConstSharedPtr", "std_msgs/msg/String"),
        ("std::string", ""),
        ("String", ""),
    ],
)
def test_a_type_is_a_message_of_a_package(written, expected):
    assert cpp_message_type(TypeRef(written)) == expected


@pytest.mark.parametrize(
    "pointer", ["Ptr", "ConstPtr", "SharedPtr", "ConstSharedPtr", "UniquePtr", "ConstUniquePtr"]
)
def test_a_pointer_to_a_message_without_its_package_is_none(pointer):
    """`using namespace` leaves the package out: Mode is none in `Mode::SharedPtr`."""
    assert cpp_message_type(TypeRef(f"Mode::{pointer}")) == ""


@pytest.mark.parametrize(
    ("name", "header"),
    [
        ("String", "m/msg/string.hpp"),
        ("UInt8MultiArray", "m/msg/u_int8_multi_array.hpp"),
        ("GPSFix", "m/msg/gps_fix.hpp"),
        ("Twist2D", "m/msg/twist2_d.hpp"),
    ],
)
def test_the_header_of_a_type_is_in_small_letters(name, header):
    assert message_header("m", "msg", name) == header


@pytest.mark.parametrize(
    ("top", "call"),
    [
        ("bool serve(Start::Request &, Start::Response &) {}", 'advertiseService("s", serve)'),
        ("bool serve(StartRequest &, StartResponse &) {}", 'advertiseService("s", serve)'),
        ("", 'serviceClient<Start>("s")'),
    ],
)
def test_a_header_says_of_which_package_a_type_is(top, call):
    """Neither package defines its types here."""
    both = "using namespace others;\nusing namespace mine;\n"
    found = ros1_runs.cpp(f"nh.{call};", f'#include "mine/Start.h"\n{both}{top}')
    assert [d.type for d in found.declarations if d.name.endswith("s")] == ["mine/Start"]


def test_a_header_says_of_which_package_a_type_of_ros2_is():
    top = "using namespace others::msg;\nusing namespace mine::msg;"
    body = 'create_publisher<GPSFix>("fix", 1);'
    found = ros2_runs.cpp(body, top=f'#include "mine/msg/gps_fix.hpp"\n{top}')
    assert ros2_runs.explicit_declarations(found) == ["publish /ns/fix mine/msg/GPSFix"]


OWN_NAMESPACE = """#include <rclcpp/rclcpp.hpp>
#include "maps/msg/map.hpp"
namespace maps {{ namespace server {{
struct N : rclcpp::Node {{
  N() : Node("written") {{ create_subscription<msg::Map>("m", 1, &N::read); }}
  void read(const {written} &) {{ create_publisher<{written}>("out", 1); }}
}};
}} }}
int main() {{ rclcpp::spin(std::make_shared<maps::server::N>()); }}
"""


@pytest.mark.parametrize("written", ["msg::Map", "maps::msg::Map", "::maps::msg::Map"])
def test_a_type_is_found_from_within_its_packages_namespace(written):
    found = ros2_runs.run_text(OWN_NAMESPACE.format(written=written))
    assert ros2_runs.explicit_declarations(found) == [
        "subscribe /ns/m maps/msg/Map",
        "publish /ns/out maps/msg/Map",
    ]


@pytest.mark.parametrize("written", ["maps::Alias", "maps::Types::Alias", "maps::Pointer"])
def test_an_alias_means_the_same_type_outside_of_its_namespace(written):
    top = """#include "maps/msg/map.hpp"
    namespace maps { using Alias = msg::Map; using Pointer = msg::Map::SharedPtr;
    struct Types { typedef msg::Map Alias; }; }"""
    found = ros2_runs.cpp(f'create_subscription("m", 1, [](const {written} &) {{}});', top=top)
    assert ros2_runs.explicit_declarations(found) == ["subscribe /ns/m maps/msg/Map"]


def test_a_type_is_found_through_the_namespace_that_is_used():
    top = '#include "maps/msg/map.hpp"\nusing namespace maps;'
    found = ros2_runs.cpp('create_publisher<msg::Map>("m", 1);', top=top)
    assert ros2_runs.explicit_declarations(found) == ["publish /ns/m maps/msg/Map"]


def test_a_type_of_ros1_is_found_from_within_its_packages_namespace():
    top = '#include "maps/Map.h"\nnamespace maps { void join(ros::NodeHandle& nh) {'
    found = ros1_runs.cpp("maps::join(nh);", top + ' nh.advertise<Map>("m", 1); }}')
    assert [d.type for d in found.declarations] == ["maps/Map"]


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
