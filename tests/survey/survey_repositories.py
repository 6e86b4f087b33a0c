"""Repositories with apps of both ROS, and launch files that are none."""

MANIFEST = (
    "<package><name>{}</name><version>1.0.0</version><description>x</description>"
    "<depend>{}</depend></package>"
)
ROS2_MANIFEST = (
    "<package format='3'><name>{}</name><version>1.0.0</version><description>x</description>"
    "<exec_depend>{}</exec_depend><export><build_type>ament_cmake</build_type></export></package>"
)
TALKER = """#!/usr/bin/env python
import rospy
from geometry_msgs.msg import Twist
rospy.init_node("{0}")
rospy.Publisher("cmd_vel", Twist, queue_size=1)
"""
BASE = """#!/usr/bin/env python
import rospy
from geometry_msgs.msg import Twist
rospy.init_node("base")
rospy.Subscriber("cmd_vel", Twist, print)
"""
FILES = {
    "drive/drive_base/package.xml": MANIFEST.format("drive_base", "rospy"),
    "drive/drive_base/scripts/base": BASE,
    "drive/drive_base/scripts/talker": TALKER.format("talker"),
    "drive/drive_base/launch/two.launch": """<launch>
      <include file="$(find drive_base)/launch/part.launch"/>
      <node pkg="drive_base" type="talker" name="one"/>
      <node pkg="drive_base" type="talker" name="two"/>
    </launch>""",
    "drive/drive_base/launch/part.launch": """<launch>
      <node pkg="drive_base" type="base" name="base"/>
    </launch>""",
    "drive/drive_base/launch/asks.launch": '<launch><arg name="robot"/></launch>',
    "drive/drive_base/launch/broken.launch": "<launch>",
    "other/other_app/package.xml": MANIFEST.format("other_app", "drive_base"),
    "other/other_app/launch/one.launch": """<launch>
      <include file="$(find drive_base)/launch/part.launch"/>
      <node pkg="drive_base" type="talker" name="one"/>
    </launch>""",
}
TURTLE = "<launch>\n  <node pkg='turtlesim' exec='turtlesim_node' name='sim'/>\n</launch>"
TELEOP = """<launch>
  <include file="$(find-pkg-share turtle_base)/launch/sim.launch.xml"/>
  <node pkg="turtlesim" exec="turtle_teleop_key" name="teleop"/>
</launch>"""
ROS2_FILES = {
    "me/base@abc1234/turtle_base/package.xml": ROS2_MANIFEST.format("turtle_base", "turtlesim"),
    "me/base@abc1234/turtle_base/launch/sim.launch.xml": TURTLE,
    "me/base@abc1234/turtle_base/launch/asks.launch.py": (
        "from launch import LaunchDescription\n"
        "from launch.actions import DeclareLaunchArgument\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([DeclareLaunchArgument('robot')])\n"
    ),
    "me/base@abc1234/turtle_base/test/check.launch.xml": TURTLE,
    "me/app@def5678/turtle_app/package.xml": ROS2_MANIFEST.format("turtle_app", "turtle_base"),
    "me/app@def5678/turtle_app/launch/drive.launch.xml": TELEOP,
}
