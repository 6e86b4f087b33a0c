"""What a launch of ROS 2 wires in vain: remaps, shared outputs, topics that parameters name."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

SETUP = """from setuptools import setup
setup(name="app", entry_points={"console_scripts": ["camera = app.camera:main"]})
"""
CAMERA = """import rclpy
from rclpy.node import Node
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import Image, CameraInfo
from tf2_ros import StaticTransformBroadcaster
class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.declare_parameter("image_topic", "/image")
        self.image = self.create_publisher(Image, "image", 1)
        self.info = self.create_publisher(CameraInfo, "info", 1)
        self.broadcaster = StaticTransformBroadcaster(self)
        mount = TransformStamped(child_frame_id=self.get_name())
        mount.header.frame_id = self.declare_parameter("parent", "base").value
        self.broadcaster.sendTransform([mount])
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

    def scan(kind, more="", **cameras):
        nodes = "".join(NODE.format(name, inside) for name, inside in cameras.items())
        launch.write_text(f"<launch>{nodes}{more}</launch>")
        graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
        return [
            (fact.subject, fact.value, *fact.others) for fact in graph.wiring if fact.kind == kind
        ]

    return scan


def remap(source, target):
    return f'<remap from="{source}" to="{target}"/>'


def test_a_remap_that_changes_no_name_is_found_where_others_use_it(facts):
    left, right = remap("left/image", "a"), remap("image", "left/image")
    assert facts("idle_remap", left=left, right=right) == [("/left/image", "/a", "/right")]
    assert facts("idle_remap", left=remap("image", "a"), right="") == []


UNREAD = '<node pkg="nowhere" exec="gone" name="gone">{}</node>'
CONTROLLERS = '<node pkg="controller_manager" exec="ros2_control_node">{}</node>'


@pytest.mark.parametrize(
    ("more", "kinds"),
    [
        ("", ["unused_remap", "idle_remap"]),
        (UNREAD, []),
        # a model may lack what its node has, too
        (CONTROLLERS, ["unused_remap"]),
    ],
)
def test_one_that_nobody_uses_is_found_where_the_nodes_are_read_whole(facts, more, kinds):
    idle = remap("nothing", "b")
    for kind in ("unused_remap", "idle_remap"):
        found = [fact[:2] for fact in facts(kind, more.format(idle), left=idle)]
        assert found == [("/nothing", "/b")] * (kind in kinds)


def test_what_others_use_a_model_may_lack(facts):
    idle, other = CONTROLLERS.format(remap("used", "b")), remap("image", "used")
    assert facts("unused_remap", idle, right=other) == [("/used", "/b", "/controller_manager")]
    assert facts("idle_remap", idle, right=other) == []


def test_a_node_that_is_not_read_has_the_names_that_the_launch_gives_it(facts, tmp_path):
    section = "{}: {{ros__parameters: {{output: /{}}}}}\n"
    sections = section.format("gone", "mine") + section.format("left", "others")
    (tmp_path / "gone.yaml").write_text(sections)
    given = f'<param from="{tmp_path}/gone.yaml"/>'
    assert facts("unread_node", UNREAD.format(given)) == [("/gone", "", "/mine")]
    given = remap("in", "/cmd_vel") + '<param name="topic" value="fast/vel"/>'
    given += '<param name="speed" value="1.5"/><param name="text" value="two words"/>'
    assert facts("unread_node", UNREAD.format(given)) == [("/gone", "", "/cmd_vel", "/fast/vel")]


def test_what_instances_share_while_their_other_topics_differ_is_found(facts):
    both = {"left": remap("info", "/l/info"), "right": remap("info", "/r/info")}
    assert facts("shared_output", **both) == [("/image", "", "/left", "/right")]
    assert facts("shared_output", left="", right="") == []


CLOCK = (
    '<node pkg="ros_gz_bridge" exec="parameter_bridge" name="{}" '
    'args="/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"{}/>'
)
SECOND_CLOCK = CLOCK.format("a", "{}") + "\n" + CLOCK.format("b", "")


def test_a_second_clock_is_found(facts):
    assert facts("second_source", SECOND_CLOCK.format("")) == [("/clock", "", "/a", "/b")]
    assert facts("second_source", SECOND_CLOCK.format(' namespace="sim"')) == [
        ("/clock", "", "/b", "/sim/a")
    ]
    assert facts("second_source", CLOCK.format("a", "")) == []
    either = SECOND_CLOCK.format(' if="$(env EITHER)"')
    assert facts("second_source", either) == []


def test_joint_states_beside_a_publisher_of_all_joints_are_found(facts):
    bridge = CLOCK.replace(
        "/clock@rosgraph_msgs/msg/Clock", "/joint_states@sensor_msgs/msg/JointState"
    )
    arms = bridge.format("a", "") + "\n" + bridge.format("b", "")
    assert facts("second_source", arms) == []
    zeros = '\n<node pkg="joint_state_publisher" exec="joint_state_publisher" name="zeros"/>'
    assert facts("second_source", bridge.format("a", "") + zeros) == [
        ("/joint_states", "", "/a", "/zeros")
    ]


def test_two_maps_are_found_also_of_one_program(facts):
    server = '<node pkg="nav2_map_server" exec="map_server" name="map_server"/>\n'
    slam = '<node pkg="slam_toolbox" exec="sync_slam_toolbox_node" name="slam"/>'
    assert facts("second_source", server + slam) == [("/map", "", "/map_server", "/slam")]
    twice = server + server.replace('name="map_server"', 'name="second"')
    assert facts("second_source", twice) == [("/map", "", "/map_server", "/second")]


def test_a_clock_of_instances_with_other_topics_is_told_once(facts):
    end = "gz.msgs.Clock"
    bridges = "\n".join(
        CLOCK.format(name, "").replace(end, f"{end} /{name}@std_msgs/msg/Bool[gz.msgs.Boolean")
        for name in ("a", "b")
    )
    assert facts("second_source", bridges) == [("/clock", "", "/a", "/b")]
    assert facts("shared_output", bridges) == []


@pytest.mark.parametrize(("value", "is_found"), [("/images", True), ("/image", False)])
def test_a_parameter_that_names_a_topic_near_one_that_is_used(facts, value, is_found):
    param = f'<param name="image_topic" value="{value}"/>'
    expected = [("/left/image_topic", "/images", "/image")] if is_found else []
    assert facts("topic_parameter", left=param) == expected


FIXED = (
    '<node pkg="tf2_ros" exec="static_transform_publisher" {}'
    ' args="--x -1 --frame-id {} --child-frame-id {}"/>'
)
FIXED_BY_WORDS = (
    '<node pkg="tf2_ros" exec="static_transform_publisher" args="0 0 -1 0 0 0 base left"/>'
)
MOVED = (
    '<group><set_remap from="/tf" to="/other/tf"/><set_remap from="/tf_static" to="/other/st"/>'
    "{}</group>"
)


@pytest.mark.parametrize(
    ("element", "kind"),
    [
        (FIXED.format("", "base", "left"), "double_fixed_frame"),
        (FIXED_BY_WORDS, "double_fixed_frame"),
        (FIXED.format('if="$(command x)"', "base", "left"), "possible_double_frame"),
    ],
)
def test_a_frame_that_two_nodes_broadcast_is_found(facts, element, kind):
    name = "/static_transform_publisher_{id}"
    assert facts(kind, element, left="") == [("left", "base", "/left", name)]


def test_parents_that_differ_have_a_fact_each(facts):
    found = facts("double_frame", FIXED.format('name="mount"', "mast", "left"), left="")
    assert found == [("left", "base", "/left"), ("left", "mast", "/mount")]


def test_nodes_without_a_name_are_several_and_one_name_is_one_node(facts):
    named, unnamed = (FIXED.format(name, "base", "x") + "\n" for name in ('name="a"', ""))
    assert facts("double_fixed_frame", named * 2) == []
    name = "/static_transform_publisher_{id}"
    assert facts("double_fixed_frame", unnamed * 2) == [("x", "base", name, name)]


@pytest.mark.parametrize("frames", [("base", "other"), ("base", "$(var unknown)")])
def test_other_frames_are_not_found(facts, frames):
    assert facts("double_fixed_frame", FIXED.format("", *frames), left="") == []


def test_frames_on_other_topics_are_not_found(facts):
    other = MOVED.format(FIXED.format("", "base", "left"))
    assert facts("double_fixed_frame", other, left="") == []
    unknown = MOVED.format(FIXED.format('name="a"', "base", "x") + FIXED.format("", "base", "x"))
    assert facts("double_fixed_frame", unknown)
    assert facts("double_fixed_frame", unknown.replace("other", "$(command x)")) == []


@pytest.mark.parametrize(
    ("frames", "loop"),
    [
        ([("b", "a"), ("a", "b")], ["a", "b"]),
        ([("b", "a"), ("c", "b"), ("a", "c")], ["a", "b", "c"]),
        ([("a", "x"), ("b", "a"), ("x", "b"), ("x", "leaf"), ("root", "x")], ["a", "b", "x"]),
        ([("b", "a"), ("root", "b"), ("root", "c")], []),
        ([("a", "a")], []),
    ],
)
def test_a_loop_of_frames_is_found_with_who_broadcasts_it(facts, frames, loop):
    nodes = [FIXED.format(f'name="n{i}"', *pair) for i, pair in enumerate(frames)]
    names = {child: f"/n{i}" for i, (parent, child) in enumerate(frames) if parent != "root"}
    expected = [(loop[0], frame, names[frame]) for frame in loop]
    assert facts("frame_loop", "\n".join(nodes)) == expected


def test_a_loop_that_a_condition_not_known_decides_on_is_none(facts):
    nodes = FIXED.format('name="n" if="$(command x)"', "a", "b") + FIXED.format("", "b", "a")
    assert facts("frame_loop", nodes) == []


MANAGED = """
<node pkg="nav2_amcl" exec="amcl" name="amcl"/>
<node pkg="tf2_ros" exec="static_transform_publisher" name="mount" args="0 0 0 0 0 0 map odom"/>
<node pkg="nav2_lifecycle_manager" exec="lifecycle_manager" name="manager">
<param name="autostart" value="{}"/><param name="node_names" value="[amcl]"/></node>
"""


@pytest.mark.parametrize(
    ("autostart", "kind"), [("true", "double_frame"), ("false", "possible_double_frame")]
)
def test_a_managed_node_broadcasts_once_it_is_activated(facts, autostart, kind):
    assert facts(kind, MANAGED.format(autostart)) == [("odom", "map", "/amcl", "/mount")]
