"""Plugins of a description, whatever it was read from."""

import pytest

from rtron.sources.gazebo import plugin_library, read_plugins
from rtron.sources.xacro import parse_element
from rtron.vocabulary import Evidence

URDF = """<?xml version="1.0" encoding="utf-8"?>
<robot name="r">
  <plugin filename="not_in_gazebo.so" name="no"/>
  <gazebo>
    <plugin name="drive" filename="libdrive.so">
      <topic> cmd_vel </topic><joint>a</joint><joint>b</joint><joint>c</joint>
      <inner><x>1</x></inner><empty/>
    </plugin>
  </gazebo>
  <gazebo reference="camera_link">
    <material>Gazebo/Red</material>
    <sensor type="multicamera" name="eyes">
      <camera name="left"/><camera name="right"/>
      <plugin name="eyes_plugin" filename="/opt/lib/libeyes.so"/>
    </sensor>
    <sensor type="ray" name="laser"><plugin/></sensor>
  </gazebo>
</robot>"""


def test_the_plugins_of_a_urdf():
    drive, eyes, bare = read_plugins(parse_element(URDF, "robot.urdf"))
    assert (drive.filename, drive.name) == ("drive", "drive")
    assert drive.values == {
        "topic": "cmd_vel",
        "joint": ["a", "b", "c"],
        "inner": {"x": "1"},
        "empty": "",
    }
    assert drive.evidence == Evidence(file="robot.urdf", line=5)
    assert (drive.sensor, drive.link) == (None, "")
    assert (eyes.filename, eyes.link) == ("eyes", "camera_link")
    sensor = eyes.sensor
    expected = ("multicamera", "eyes", ("left", "right"))
    assert (sensor.type, sensor.name, sensor.cameras) == expected
    assert (bare.filename, bare.name) == ("", "")


@pytest.mark.parametrize(
    ("filename", "library"),
    [
        ("libgazebo_ros_camera.so", "gazebo_ros_camera"),
        ("gazebo_ros_camera", "gazebo_ros_camera"),
        (" /a/libx.so ", "x"),
        ("x.so", "x"),
        ("liblib.so.so", "lib.so"),
        ("", ""),
    ],
)
def test_a_library_is_named_without_lib_and_so(filename, library):
    assert plugin_library(filename) == library
