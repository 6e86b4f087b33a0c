"""Facts of packages out of their files."""

import os

import pytest

from rtron.functions.reading.package_code import MAX_BYTES, MAX_FACTS, MAX_FILES, read_code
from rtron.functions.repository import SourcePackage, SourceRepository

CPP = """
#include <ros/ros.h>
#include <sensor_msgs/LaserScan.h>
#include "apriltag_ros/AprilTagDetectionArray.h"
#include <sensor_msgs/msg/point_cloud2.hpp>
// pub = nh.advertise<std_msgs::String>("commented", 1);
void onJoy(const sensor_msgs::JoyConstPtr& joy);
void onImu(const sensor_msgs::Imu::ConstPtr & imu);
rclcpp::Publisher<geometry_msgs::msg::Twist>::SharedPtr twist;
image_transport::CameraPublisher images;
int main() {
  nh.advertise<nav_msgs::Odometry>("odom", 1);
  nh.advertise<AprilTagDetectionArray>("tags", 1);
  nh.advertise<Unknown>("unknown", 1);
  node->create_subscription<nav_msgs::msg::Path>("path", 1, f);
  nh.subscribe<std_msgs::Bool>("stop", 1, f);
}
"""
PYTHON = """
from geometry_msgs.msg import Twist, PoseStamped as Pose
from sensor_msgs.msg import (
    Joy,
    Image,
)
import std_msgs.msg
# rospy.Publisher("commented", Image)
rospy.Publisher("cmd_vel", Twist, queue_size=1)
rospy.Subscriber("joy", Joy, on_joy)
self.create_publisher(Pose, "pose", 10)
self.create_subscription(Image, "image", on_image, 10)
"""
CMAKE = """
find_package(catkin REQUIRED COMPONENTS
  roscpp joy)
find_package(OpenCV REQUIRED)  # find_package(commented)
pluginlib_export_plugin_description_file(rviz_common plugins.xml)
"""
MANIFEST = """<package><name>p</name>
  <export><nav_core plugin="${prefix}/planner.xml"/><build_type>x</build_type></export></package>"""


@pytest.fixture
def package(tmp_path):
    folder = tmp_path / "p"
    folder.mkdir()
    return folder


def facts(folder, *kinds):
    """Return the facts of a package, or those of some kinds."""
    repository = SourceRepository(
        name="r", packages=(SourcePackage(name="p", depends=("x",), folder=folder),)
    )
    (package,) = read_code(repository).packages
    assert package.depends == ("x",)
    return {fact for fact in package.code if not kinds or fact.split()[0] in kinds}


def test_cpp(package):
    (package / "node.cpp").write_text(CPP)
    assert facts(package, "uses", "publishes", "subscribes") == {
        "uses sensor_msgs/LaserScan",
        "uses sensor_msgs/PointCloud2",
        "uses apriltag_ros/AprilTagDetectionArray",
        "publishes geometry_msgs/Twist",
        "publishes nav_msgs/Odometry",
        "publishes apriltag_ros/AprilTagDetectionArray",
        "publishes sensor_msgs/Image",
        "subscribes sensor_msgs/Joy",
        "subscribes sensor_msgs/Imu",
        "subscribes nav_msgs/Path",
        "subscribes std_msgs/Bool",
    }


def test_python(package):
    (package / "scripts").mkdir()
    (package / "scripts/node.py").write_text(PYTHON)
    assert facts(package, "uses", "publishes", "subscribes") == {
        "uses geometry_msgs/Twist",
        "uses geometry_msgs/PoseStamped",
        "uses sensor_msgs/Joy",
        "uses sensor_msgs/Image",
        "publishes geometry_msgs/Twist",
        "publishes geometry_msgs/PoseStamped",
        "subscribes sensor_msgs/Joy",
        "subscribes sensor_msgs/Image",
    }


def test_headers_modules_and_plugin_classes(package):
    (package / "node.cpp").write_text(
        """
#include "linux/can.h"
#  include <opencv2/aruco.hpp>
// #include <commented.h>
PLUGINLIB_EXPORT_CLASS(mine::Planner, nav_core::BaseGlobalPlanner)
PLUGINLIB_EXPORT_CLASS ( mine::Panel<int> , ::rviz::Panel)
PLUGINLIB_DECLARE_CLASS(mine, Old, mine::Old, nodelet::Nodelet)
GZ_REGISTER_MODEL_PLUGIN(Mine)
"""
    )
    (package / "node.py").write_text("import serial\nfrom smbus2 import SMBus\n# import torch\n")
    assert facts(package, "includes", "imports", "plugs") == {
        "includes linux/can.h",
        "includes opencv2/aruco.hpp",
        "imports serial",
        "imports smbus2",
        "plugs nav_core::BaseGlobalPlanner",
        "plugs rviz::Panel",
        "plugs nodelet::Nodelet",
        "plugs gazebo",
    }


def test_the_kinds_of_files(package):
    for name in ("msg/A.msg", "urdf/a.urdf.xacro", "meshes/B.STL", "c.world", "d.rviz"):
        (package / name).parent.mkdir(exist_ok=True)
        (package / name).write_text("")
    (package / "setup.py").write_text("")
    (package / "e.launch.py").write_text("")
    expected = {"ships interfaces", "ships models", "ships worlds", "ships settings"}
    assert facts(package, "ships") == expected
    (package / "f.cc").write_text("")
    assert facts(package, "ships") == {*expected, "ships code"}


@pytest.mark.parametrize(
    "call", ["ExternalProject_Add(x", "ament_vendor (x", "FetchContent_Declare(x"]
)
def test_what_is_fetched_to_be_built(package, call):
    (package / "CMakeLists.txt").write_text(f"{call} GIT_REPOSITORY y)")
    assert facts(package) == {"builds elsewhere"}
    (package / "CMakeLists.txt").write_text(f"# {call} GIT_REPOSITORY y)")
    assert facts(package) == set()


def test_a_fact_that_is_there_often_counts_once(package):
    (package / "a.py").write_text("import os\n" * MAX_FACTS)
    (package / "b.py").write_text("import serial\n")
    assert facts(package, "imports") == {"imports os", "imports serial"}


def test_build_files_and_manifests(package):
    (package / "CMakeLists.txt").write_text(CMAKE)
    (package / "package.xml").write_text(MANIFEST)
    assert facts(package) == {
        "depends roscpp",
        "depends joy",
        "depends opencv",
        "exports rviz_common",
        "exports nav_core",
    }


def test_launch_files(package):
    (package / "a.launch").write_text('<launch><node pkg="amcl" type="amcl" name="a"/></launch>')
    (package / "b.launch.py").write_text("Node(package='nav2_planner', executable='p')")
    (package / "c.launch.xml").write_text('<launch><node pkg="rviz2" exec="rviz2"/></launch>')
    (package / "d.yaml").write_text('package="ignored"')
    assert facts(package, "launches", "depends") == {
        "launches amcl",
        "launches nav2_planner",
        "launches rviz2",
    }


def test_tests_and_what_lies_elsewhere_say_nothing(package, tmp_path):
    (package / "test").mkdir()
    (package / "test/node.cpp").write_text(CPP)
    (tmp_path / "elsewhere.py").write_text(PYTHON)
    (package / "link.py").symlink_to(tmp_path / "elsewhere.py")
    os.mkfifo(package / "pipe.py")
    assert facts(package) == set()


def test_a_file_too_large_or_no_text_says_nothing_and_the_others_count(package):
    (package / "large.py").write_text(PYTHON + " " * MAX_BYTES)
    (package / "binary.py").write_bytes(b"\x00\xff\xfe" * 99)
    (package / "node.launch").write_text('<node pkg="amcl"/>')
    assert facts(package) == {"launches amcl", "ships code"}


def test_files_past_the_limit_say_nothing(package):
    for number in range(MAX_FILES):
        (package / f"{number:04}.py").write_text("")
    (package / "9999.py").write_text(PYTHON)
    assert facts(package) == {"ships code"}


def test_facts_past_the_limit_do_not_count(package):
    nodes = "".join(f'<node pkg="p{number}"/>' for number in range(MAX_FACTS + 9))
    (package / "a.launch").write_text(nodes)
    assert len(facts(package)) == MAX_FACTS


def test_a_broken_manifest_says_nothing_and_the_others_count(package):
    (package / "package.xml").write_text("<package")
    (package / "CMakeLists.txt").write_text(CMAKE)
    assert "depends joy" in facts(package)


def test_a_package_without_a_folder_stays_as_it_is():
    repository = SourceRepository(name="r", packages=(SourcePackage(name="p"),))
    assert read_code(repository) == repository
