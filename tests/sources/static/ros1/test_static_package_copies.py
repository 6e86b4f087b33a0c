"""A workspace may hold a changed copy of a package that a model knows."""

from test_static_app import ends

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app

MANIFEST = "<package><name>move_base</name></package>"
CMAKE = """project(move_base)
find_package(catkin REQUIRED COMPONENTS roscpp)
add_executable(move_base main.cpp)
"""
SOURCE = """#include <ros/ros.h>
#include <geometry_msgs/Twist.h>
int main(int argc, char** argv) {{
  ros::init(argc, argv, "move_base");
  ros::NodeHandle nh;
  ros::Publisher p = nh.advertise<geometry_msgs::Twist>("{topic}", 1);
  ros::spin();
}}
"""
LAUNCH = '<launch><node pkg="move_base" type="move_base" name="move_base"/></launch>'


def published(tmp_path, topic):
    package = tmp_path / "move_base"
    package.mkdir()
    (package / "package.xml").write_text(MANIFEST)
    (package / "CMakeLists.txt").write_text(CMAKE)
    (package / "main.cpp").write_text(SOURCE.format(topic=topic))
    (package / "app.launch").write_text(LAUNCH)
    options = ScanOptions(workers=1, cache=None)
    graph = scan_app([tmp_path], [(package / "app.launch", {})], {}, options).graph
    return ends(graph, "/move_base")


def test_what_the_copy_publishes_beside_the_model_is_seen(tmp_path):
    found = published(tmp_path, "elsewhere/cmd_vel")
    assert "> /elsewhere/cmd_vel" in found
    assert "> /cmd_vel" in found


def test_what_both_say_stands_there_once(tmp_path):
    assert published(tmp_path, "cmd_vel") == published_by_model(tmp_path)


def published_by_model(tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    launch = empty / "app.launch"
    launch.write_text(LAUNCH)
    graph = scan_app([empty], [(launch, {})], {}, ScanOptions(workers=1, cache=None)).graph
    return ends(graph, "/move_base")
