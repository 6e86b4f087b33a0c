"""What a launch of ROS 2 wires in vain: remaps, shared outputs, topics that parameters name."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

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
def facts(tmp_path):
    """Return the facts of a kind of an app of cameras, given by name with what is in them."""
    (tmp_path / "app").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>app</name></package>")
    (tmp_path / "setup.py").write_text(SETUP)
    (tmp_path / "app/__init__.py").touch()
    (tmp_path / "app/camera.py").write_text(CAMERA)
    launch = tmp_path / "app.launch.xml"

    def scan(kind, **cameras):
        nodes = "".join(NODE.format(name, inside) for name, inside in cameras.items())
        launch.write_text(f"<launch>{nodes}</launch>")
        graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
        return [
            (fact.subject, fact.value, *fact.others) for fact in graph.wiring if fact.kind == kind
        ]

    return scan


def remap(source, target):
    return f'<remap from="{source}" to="{target}"/>'


def test_a_remap_that_changes_no_name_is_found_where_others_use_it(facts):
    left = remap("left/image", "a") + remap("nothing", "b")
    right = remap("image", "left/image")
    assert facts("idle_remap", left=left, right=right) == [("/left/image", "/a", "/right")]
    assert facts("idle_remap", left=remap("image", "a"), right="") == []


def test_what_instances_share_while_their_other_topics_differ_is_found(facts):
    both = {"left": remap("info", "/l/info"), "right": remap("info", "/r/info")}
    assert facts("shared_output", **both) == [("/image", "", "/left", "/right")]
    assert facts("shared_output", left="", right="") == []


@pytest.mark.parametrize(("value", "is_found"), [("/images", True), ("/image", False)])
def test_a_parameter_that_names_a_topic_near_one_that_is_used(facts, value, is_found):
    param = f'<param name="image_topic" value="{value}"/>'
    expected = [("/left/image_topic", "/images", "/image")] if is_found else []
    assert facts("topic_parameter", left=param) == expected
