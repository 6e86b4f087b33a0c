"""A small catkin workspace: C++, Python, a nodelet, shell, and nodes that start others."""

import pytest
from file_tree import write

MANIFEST = """<package format="2"><name>{name}</name><version>1.0.0</version>
<description>d</description><maintainer email="a@b.c">m</maintainer><license>BSD</license>
<buildtool_depend>catkin</buildtool_depend><depend>nodelet</depend>
<export><nodelet plugin="${{prefix}}/nodelets.xml"/></export></package>
"""
FILES = {
    "robot/package.xml": MANIFEST.format(name="robot"),
    "robot/CMakeLists.txt": """cmake_minimum_required(VERSION 3.0)
project(robot)
find_package(catkin REQUIRED COMPONENTS roscpp nodelet)
catkin_package()
include_directories(include ${catkin_INCLUDE_DIRS})
add_executable(driver src/driver.cpp)
add_library(filters src/filter.cpp)
""",
    "robot/nodelets.xml": """<library path="lib/libfilters">
<class name="robot/Filter" type="robot::Filter" base_class_type="nodelet::Nodelet"/>
</library>
""",
    "robot/include/robot/names.h": '#define COMMAND "cmd_vel"\n',
    "robot/src/driver.cpp": """#include <ros/ros.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Odometry.h>
#include "robot/names.h"
void onCommand(const geometry_msgs::Twist& m) {}
int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh, own("~");
  ros::Subscriber s = nh.subscribe(COMMAND, 1, onCommand);
  std::string odom;
  own.param<std::string>("odom_topic", odom, "odom");
  ros::Publisher p = nh.advertise<nav_msgs::Odometry>(odom, 1);
  ros::spin();
}
""",
    "robot/src/filter.cpp": """#include <nodelet/nodelet.h>
#include <sensor_msgs/Image.h>
#include <pluginlib/class_list_macros.h>
namespace robot {
class Filter : public nodelet::Nodelet {
  virtual void onInit() {
    sub_ = getNodeHandle().subscribe("image", 1, &Filter::call, this);
    pub_ = getPrivateNodeHandle().advertise<sensor_msgs::Image>("out", 1);
  }
  void call(const sensor_msgs::Image& m) {}
  ros::Subscriber sub_;
  ros::Publisher pub_;
};
}
PLUGINLIB_EXPORT_CLASS(robot::Filter, nodelet::Nodelet)
""",
    "robot/scripts/teleop.py": """#!/usr/bin/env python
import rospy
import actionlib
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseAction
rospy.init_node("teleop")
pub = rospy.Publisher("cmd_vel", Twist, queue_size=1)
client = actionlib.SimpleActionClient("go", MoveBaseAction)
rospy.spin()
""",
    "robot/scripts/boss.py": """#!/usr/bin/env python
import subprocess
import rospy
rospy.init_node("boss")
subprocess.Popen(["roslaunch", "robot", "more.launch", "who:=late"])
subprocess.Popen(["roslaunch", "robot", "boss.launch"])
subprocess.Popen(["roslaunch", "robot", "none.launch"])
""",
    "robot/scripts/run.sh": """#!/bin/bash
rosrun robot teleop.py __name:=by_hand cmd_vel:=/by_hand/cmd_vel
roslaunch $PACKAGE x.launch
""",
    "robot/launch/app.launch": """<launch>
  <arg name="odom" default="odom"/>
  <param name="use_sim_time" value="true"/>
  <group ns="base">
    <node pkg="robot" type="driver" name="driver">
      <param name="odom_topic" value="$(arg odom)"/>
      <remap from="cmd_vel" to="/cmd_vel"/>
    </node>
  </group>
  <node pkg="robot" type="teleop.py" name="teleop" args="cmd_vel:=joy_vel">
    <remap from="cmd_vel" to="/cmd_vel"/>
    <remap from="go/goal" to="elsewhere"/>
  </node>
</launch>
""",
    "robot/launch/nodelets.launch": """<launch>
  <node pkg="nodelet" type="nodelet" name="manager" args="manager"/>
  <node pkg="nodelet" type="nodelet" name="filter" args="load robot/Filter /manager">
    <remap from="image" to="/camera/image"/>
  </node>
  <node pkg="nodelet" type="nodelet" name="lost" args="load robot/Unknown elsewhere"/>
</launch>
""",
    "robot/launch/boss.launch": """<launch>
  <node pkg="robot" type="boss.py" name="boss"/>
  <node pkg="robot" type="run.sh" name="run"/>
</launch>
""",
    "robot/launch/more.launch": """<launch><arg name="who"/>
  <node pkg="robot" type="teleop.py" name="$(arg who)"/>
  <node pkg="nowhere" type="thing" name="thing"/>
</launch>
""",
}


@pytest.fixture
def folder(tmp_path):
    """Return the folder of the workspace."""
    top = tmp_path / "src"
    write(top, FILES)
    return top
