"""Two repositories with an app each, and launch files that are none."""

import pytest

MANIFEST = "<package><name>{}</name><version>1.0.0</version><description>x</description></package>"
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
    "drive/drive_base/package.xml": MANIFEST.format("drive_base"),
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
    "other/other_app/package.xml": MANIFEST.format("other_app"),
    "other/other_app/launch/one.launch": """<launch>
      <include file="$(find drive_base)/launch/part.launch"/>
      <node pkg="drive_base" type="talker" name="one"/>
    </launch>""",
}


@pytest.fixture(scope="session")
def repositories(tmp_path_factory):
    top = tmp_path_factory.mktemp("repositories")
    for name, text in FILES.items():
        path = top / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    return top
