"""A package of ROS 1 in which two nodes drive one base, for tools that scan a folder."""

from file_tree import write

LAUNCH_FILE = "robot/app.launch"
_LAUNCH = """<launch>
<node pkg="robot" type="drive.py" name="a"/>
<node pkg="robot" type="drive.py" name="b"/>
<node pkg="robot" type="base.py" name="base"/>
</launch>"""
_DRIVE = """#!/usr/bin/env python
from file_tree import write
import rospy
from geometry_msgs.msg import Twist
rospy.Publisher("cmd_vel", Twist, queue_size=1)
"""
_BASE = _DRIVE.replace('Publisher("cmd_vel", Twist, queue_size=1)', 'Subscriber("cmd_vel", Twist)')
_FILES = {
    "package.xml": "<package><name>robot</name></package>",
    "CMakeLists.txt": "project(robot)",
    "launch/app.launch": _LAUNCH,
    "scripts/drive.py": _DRIVE,
    "scripts/base.py": _BASE,
}


def write_app(folder):
    """Write the package into a folder; return the package's folder."""
    write(folder / "src" / "robot", _FILES)
    return folder / "src"
