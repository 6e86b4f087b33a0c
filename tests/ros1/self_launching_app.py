"""A base whose controller starts navigation and an attacker itself, from launch files."""

import shutil

from file_tree import write
from harness import NODES
from roslaunch_oracle import package

CONTROLLER = """#!/usr/bin/python3
import os
import rospkg
import roslaunch
import rospy


class Controller:
    def __init__(self):
        self.here = os.path.dirname(os.path.realpath(__file__))
        self.top = self.here.replace("start_core/nodes", "")
        self.uuid = roslaunch.rlutil.get_or_generate_uuid(None, False)
        self.start(rospkg.RosPack().get_path("start_nav") + "/launch/nav.launch")
        self.start(self.top + "start_rogue/launch/rogue.launch")

    def start(self, path):
        self.parent = roslaunch.parent.ROSLaunchParent(self.uuid, [path])
        self.parent.start()


if __name__ == "__main__":
    rospy.init_node("controller")
    controller = Controller()
    rospy.spin()
"""
FILES = {
    "src/start_core/package.xml": package("start_core"),
    "src/start_core/nodes/controller": CONTROLLER,
    "src/start_core/start.launch": """<launch>
  <arg name="out"/>
  <node pkg="start_core" type="controller" name="controller" required="true"/>
  <node pkg="start_core" type="driver" name="driver" args="$(arg out)"/>
</launch>
""",
    "src/start_nav/package.xml": package("start_nav"),
    "src/start_nav/launch/nav.launch": """<launch>
  <include file="$(find start_nav)/launch/part.launch"/>
</launch>
""",
    "src/start_nav/launch/part.launch": """<launch>
  <node pkg="start_nav" type="nav.py" name="nav"/>
</launch>
""",
    "src/start_rogue/package.xml": package("start_rogue"),
    "src/start_rogue/launch/rogue.launch": """<launch>
  <!-- floods -->
  <node pkg="start_rogue" type="rogue.py" name="rogue" args="200"/>
</launch>
""",
}


def write_starting_app(folder, driver=None):
    """Write the packages below `folder`/src; return the launch file."""
    write(folder, FILES)
    source = folder / "src"
    shutil.copy(NODES / "nav.py", source / "start_nav")
    shutil.copy(NODES / "rogue.py", source / "start_rogue")
    (source / "start_core" / "nodes" / "controller").chmod(0o755)
    if driver:
        shutil.copy(driver, source / "start_core")
    return source / "start_core" / "start.launch"
