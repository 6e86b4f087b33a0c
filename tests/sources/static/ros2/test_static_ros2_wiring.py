"""What a launch of ROS 2 wires in vain: remaps, shared outputs, topics that parameters name."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary.causes import NO_EFFECT, SHARED_OUTPUT, UNUSED_TOPIC

SETUP = """from setuptools import setup
setup(name="app", entry_points={"console_scripts": ["camera = app.camera:main"]})
"""
CAMERA = """import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, CameraInfo
class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.declare_parameter("image_topic", "/image")
        self.image = self.create_publisher(Image, "image", 1)
        self.info = self.create_publisher(CameraInfo, "info", 1)
def main():
    rclpy.init()
    rclpy.spin(Camera())
"""
NODE = '<node pkg="app" exec="camera" name="{}">{}</node>'


@pytest.fixture
def notes(tmp_path):
    """Return the notes with a cause of an app of cameras, given by name with what is in them."""
    (tmp_path / "app").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>app</name></package>")
    (tmp_path / "setup.py").write_text(SETUP)
    (tmp_path / "app/__init__.py").touch()
    (tmp_path / "app/camera.py").write_text(CAMERA)
    launch = tmp_path / "app.launch.xml"

    def scan(cause, **cameras):
        nodes = "".join(NODE.format(name, inside) for name, inside in cameras.items())
        launch.write_text(f"<launch>{nodes}</launch>")
        graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
        return [note.what for note in graph.unresolved if note.why.startswith(cause)]

    return scan


def remap(source, target):
    return f'<remap from="{source}" to="{target}"/>'


def test_a_remap_that_changes_no_name_is_noted_where_others_use_it(notes):
    left = remap("left/image", "a") + remap("nothing", "b")
    right = remap("image", "left/image")
    assert notes(NO_EFFECT, left=left, right=right) == ["remap /left/image to /a"]
    assert notes(NO_EFFECT, left=remap("image", "a"), right="") == []


def test_what_instances_share_while_their_other_topics_differ_is_noted(notes):
    both = {"left": remap("info", "/l/info"), "right": remap("info", "/r/info")}
    assert notes(SHARED_OUTPUT, **both) == ["/image of /left, /right"]
    assert notes(SHARED_OUTPUT, left="", right="") == []


@pytest.mark.parametrize(("value", "is_noted"), [("/images", True), ("/image", False)])
def test_a_parameter_that_names_a_topic_near_one_that_is_used(notes, value, is_noted):
    param = f'<param name="image_topic" value="{value}"/>'
    expected = ["parameter /left/image_topic is /images"] if is_noted else []
    assert notes(UNUSED_TOPIC, left=param) == expected
