"""Frames of messages and look-ups that no transform of an app has, in both generations of ROS."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.sources.static.ros2.app import scan_ros2_app

NODES = {
    1: """#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import LaserScan
rospy.init_node("laser")
pub = rospy.Publisher("scan", LaserScan, queue_size=1)
scan = LaserScan()
scan.header.frame_id = "{}"
pub.publish(scan)
{}
""",
    2: """#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
rclpy.init()
node = Node("laser")
pub = node.create_publisher(LaserScan, "scan", 1)
scan = LaserScan()
scan.header.frame_id = "{}"
pub.publish(scan)
{}
""",
}
KEYS = {1: "type", 2: "exec"}


@pytest.fixture
def stray_frames(tmp_path):
    """Return the stray frames of an app whose laser has one frame and whose launch has another."""

    def scan(stamped, *transforms, ros=2, more="", code="", kind="stray_frame"):
        (tmp_path / "package.xml").write_text("<package><name>app</name></package>")
        script = tmp_path / "scripts/laser.py"
        script.parent.mkdir(exist_ok=True)
        script.write_text(NODES[ros].format(stamped, code))
        script.chmod(0o755)
        fixed = "".join(
            f'<node pkg="tf2_ros" {KEYS[ros]}="static_transform_publisher" name="t{index}" '
            f'args="0 0 0 0 0 0 base_link {child}"/>'
            for index, child in enumerate(transforms)
        )
        launch = tmp_path / "app.launch.xml"
        launch.write_text(
            f'<launch><node pkg="app" {KEYS[ros]}="laser.py" name="laser"/>{fixed}{more}</launch>'
        )
        options = ScanOptions(workers=1)
        if ros == 1:
            graph = scan_app([tmp_path], [(launch, {})], {}, options).graph
        else:
            graph = scan_ros2_app([tmp_path], [(launch, {})], {}, options)
        facts = [fact for fact in graph.wiring if fact.kind == kind]
        assert {fact.others for fact in facts} <= {("/laser",), ("/r/base",)}
        return [(fact.subject, fact.value, len(fact.evidence)) for fact in facts]

    return scan


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(
    ("stamped", "near"),
    [
        ("pico_1", "pico"),
        ("front_pico", "pico"),
        ("robot/pico", "pico"),
        ("pico", "pico_link"),
        ("laser_frane", "laser_frame"),
        ("laser_upper_base", "base_laser"),
    ],
)
def test_a_frame_that_is_near_one_of_a_transform(stray_frames, ros, stamped, near):
    assert stray_frames(stamped, "wheel", near, ros=ros) == [(stamped, near, 2)]


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize("stamped", ["pico", "base_link", "sonar", "li", ""])
def test_one_that_is_known_or_like_none_is_not_found(stray_frames, ros, stamped):
    assert stray_frames(stamped, "pico", "x_li", ros=ros) == []


def test_a_slash_before_it_is_for_ros_1_alone(stray_frames):
    assert stray_frames("/pico", "pico", ros=1) == []
    assert stray_frames("/pico", "pico", ros=2) == [("/pico", "pico", 2)]


def test_a_prefix_before_the_transform_is_for_ros_2_alone(stray_frames):
    assert stray_frames("pico", "robot/pico", ros=1) == []
    assert stray_frames("pico", "robot/pico", ros=2) == [("pico", "robot/pico", 2)]


def test_the_parent_of_a_frame_is_near_too(stray_frames):
    assert stray_frames("base_link_1", "pico") == [("base_link_1", "base_link", 1)]


REALSENSE = '<node pkg="realsense2_camera" exec="realsense2_camera_node" name="camera"/>'
UNKNOWN = '<node pkg="tf2_ros" exec="static_transform_publisher" args="{}" name="x"/>'
MOVED = '<group><set_remap from="/tf" to="/a/tf"/>{}</group>'


@pytest.mark.parametrize(
    "more",
    [
        REALSENSE,
        UNKNOWN.format("0 0 0 0 0 0 base_link $(command x)"),
        UNKNOWN.format("0 0 0 0 0 0 $(command x) mast"),
        MOVED.format(UNKNOWN.format("0 0 0 0 0 0 base_link mast")),
    ],
)
def test_nothing_is_found_where_not_all_transforms_are_known(stray_frames, more):
    assert stray_frames("pico_1", "pico", more=more) == []


def test_among_very_many_transforms_none_is_near(stray_frames):
    others = [f"far{index}" for index in range(199)]
    assert stray_frames("pico_1", "pico", *others[1:]) == [("pico_1", "pico", 2)]
    assert stray_frames("pico_1", "pico", *others) == []


@pytest.fixture
def missing_frames(stray_frames):
    """Return the frames that the laser looks up and that are missing, with what is near."""

    def scan(*looked_up, transforms=("pico",), ros=2, more="", kind="missing_frame"):
        code = "".join(f"buffer.lookup_transform('', '{each}')\n" for each in looked_up)
        found = stray_frames("", *transforms, ros=ros, more=more, code=code, kind=kind)
        return [(frame, near) for frame, near, _ in found]

    return scan


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(
    ("looked_up", "expected"),
    [
        (["pico_1"], [("pico_1", "pico")]),
        (["sonar"], []),
        (["base_footprint"], [("base_footprint", "base_link")]),
        (["pico"], []),
        (["pico_1", "pico"], []),
        ([], []),
    ],
)
def test_a_frame_that_is_looked_up(missing_frames, ros, looked_up, expected):
    assert missing_frames(*looked_up, ros=ros) == expected


@pytest.mark.parametrize("ros", [1, 2])
def test_tf2_takes_no_slash_whatever_else_is_sent(missing_frames, ros):
    more = REALSENSE.replace("exec", KEYS[ros])
    assert missing_frames("/pico", ros=ros, more=more) == [("/pico", "pico")]
    assert missing_frames("/other", "/pico_1", ros=ros, more=more) == []


def test_another_launch_may_send_what_is_like_none_or_the_base(missing_frames):
    kind = "possible_missing_frame"
    assert missing_frames("sonar", kind=kind) == [("sonar", "")]
    assert missing_frames("pico_1", kind=kind) == []
    only_base = {"transforms": (), "more": UNKNOWN.format("0 0 0 0 0 0 odom base_footprint")}
    assert missing_frames("base_link", kind=kind, **only_base) == [("base_link", "base_footprint")]
    assert missing_frames("base_link", **only_base) == []


@pytest.mark.parametrize("given", ["", '<param name="tf_broadcast" value="false"/>'])
def test_a_node_of_a_model_broadcasts_what_its_parameters_say(missing_frames, given):
    base = '<param name="base_frame_id" value="base_link"/>'
    amcl = f'<node pkg="nav2_amcl" exec="amcl" name="amcl">{base}{given}</node>'
    assert missing_frames("pico_1", more=amcl) == [("pico_1", "pico")]


@pytest.mark.parametrize("more", [REALSENSE, UNKNOWN.format("0 0 0 0 0 0 base_link $(command x)")])
def test_no_frame_is_missing_where_not_all_transforms_are_known(missing_frames, more):
    assert missing_frames("pico_1", more=more) == []


def test_no_frame_is_missing_where_nobody_broadcasts_any(missing_frames):
    assert missing_frames("pico_1", transforms=()) == []


DRIVE = """<node pkg="controller_manager" exec="ros2_control_node" namespace="r">
<param name="base.type" value="diff_drive_controller/DiffDriveController"/></node>
<node pkg="controller_manager" exec="spawner" namespace="r" args="base -c /r/controller_manager
-p {}"/>"""


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("", ["r/base_link", "r/odom"]),
        ("tf_frame_prefix: s", ["s/base_link", "s/odom"]),
        ("tf_frame_prefix_enable: false", []),
    ],
)
def test_the_messages_of_a_controller_have_its_prefix(stray_frames, tmp_path, given, expected):
    parameters = f"{{enable_odom_tf: false, {given}}}"
    (tmp_path / "base.yaml").write_text(f"/r/base: {{ros__parameters: {parameters}}}\n")
    more = DRIVE.format(tmp_path / "base.yaml")
    found = stray_frames("", "odom", more=more)
    assert [(frame, near) for frame, near, _ in found] == [(e, e[2:]) for e in expected]
