"""What a bridge carries on Gazebo's side, against the systems of the robots that are spawned."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

ROBOT = """<robot name="bot"><link name="base"/><gazebo>
  <plugin filename="{library}" name="gz::sim::systems::{system}">{elements}</plugin>
</gazebo></robot>"""
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(package='ros_gz_sim', executable='create', arguments={spawned!r}),
        Node(package='ros_gz_bridge', executable='parameter_bridge', name='bridge',
             arguments={bridged!r}, parameters=[{parameters!r}]),
    ])
"""
TWIST, ODOMETRY = (
    "geometry_msgs/msg/Twist{}gz.msgs.Twist",
    "nav_msgs/msg/Odometry{}gz.msgs.Odometry",
)
CLOCK = "/clock@rosgraph_msgs/msg/Clock{}gz.msgs.Clock"
ENTRIES = """- {{ros_topic_name: /cmd_vel, gz_topic_name: "{}",
  ros_type_name: geometry_msgs/msg/Twist,
  gz_type_name: gz.msgs.Twist, direction: {}}}
"""


@pytest.fixture
def mismatched(tmp_path):
    """Return the pairs of names, of a bridge and of a plugin, that do not fit."""
    (tmp_path / "package.xml").write_text("<package><name>sim</name></package>")

    def scan(
        *bridged: str,
        elements: str = "<topic>cmd_vel</topic>",
        library: str = "gz-sim-diff-drive-system",
        spawned: tuple[str, ...] = (),
        entries: str = "",
        parameters: dict[str, object] | None = None,
        kind: str = "bridge_mismatch",
    ):
        robot, bridge, launch = (tmp_path / name for name in ("r.urdf", "b.yaml", "a.launch.py"))
        robot.write_text(ROBOT.format(library=library, system="Drive", elements=elements))
        bridge.write_text(entries or "[]")
        given = {"config_file": str(bridge), **(parameters or {})}
        words = ["-file", str(robot), *spawned]
        launch.write_text(LAUNCH.format(spawned=words, bridged=list(bridged), parameters=given))
        graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
        facts = (fact for fact in graph.wiring if fact.kind == kind)
        return [(fact.subject, fact.value, *fact.others) for fact in facts]

    return scan


def twist(name: str, sign: str = "]") -> str:
    return f"{name}@{TWIST.format(sign)}"


@pytest.mark.parametrize(
    "library",
    ["gz-sim-diff-drive-system", "libignition-gazebo6-mecanum-drive-system.so"],
)
def test_a_name_that_the_plugin_does_not_have(mismatched, library):
    expected = [("/model/bot/cmd_vel", "/cmd_vel", "/bridge")]
    assert mismatched(twist("/model/bot/cmd_vel"), library=library) == expected


@pytest.mark.parametrize("name", ["/conveyor/cmd_vel", "/model/truck/cmd_vel"])
@pytest.mark.parametrize("elements", ["", "<topic>cmd_vel</topic>"])
def test_a_name_of_another_model(mismatched, name, elements):
    assert not mismatched(twist(name), elements=elements)
    of_other = mismatched(twist(name), elements=elements, kind="other_model")
    assert of_other == [(name, "", "/bridge")]
    assert not mismatched(twist("/model/bot/cmd"), elements=elements, kind="other_model")
    assert mismatched(twist("/world/w/model/bot/cmd"), elements=elements)


@pytest.mark.parametrize(
    ("library", "is_known"),
    [
        ("libmy_truth.so", False),
        ("gz-sim-tracked-vehicle-system", False),
        ("gz-sim-imu-system", True),
        ("gz_ros2_control-system", True),
    ],
)
def test_a_plugin_whose_topics_are_not_known(mismatched, library, is_known):
    more = f'<topic>cmd_vel</topic></plugin><plugin filename="{library}" name="other">'
    assert bool(mismatched(twist("/other"), elements=more)) is is_known
    assert mismatched(twist("/cmd_vel", "["), elements=more)


def test_the_same_name_with_or_without_a_slash(mismatched):
    assert not mismatched(
        twist("cmd_vel"), twist("/other", "["), elements="<topic>/cmd_vel</topic>"
    )


def test_a_plugin_without_the_element_is_called_after_its_model(mismatched):
    assert not mismatched(twist("/model/bot/cmd_vel"), elements="")
    spawned = ("-name", "second")
    expected = [("/model/bot/cmd_vel", "/model/second/cmd_vel", "/bridge")]
    assert mismatched(twist("/model/bot/cmd_vel"), elements="", spawned=spawned) == expected


def test_an_entry_of_the_file_has_a_name_on_each_side(mismatched):
    assert not mismatched(entries=ENTRIES.format("cmd_vel", "ROS_TO_GZ"))
    expected = [("/model/bot/cmd_vel", "/cmd_vel", "/bridge")]
    entries = ENTRIES.format("/model/bot/cmd_vel", "ROS_TO_GZ")
    assert mismatched(entries=entries) == expected
    assert not mismatched(entries=entries, parameters={"expand_gz_topic_names": True})


def test_the_wrong_direction(mismatched):
    expected = [("/cmd_vel", "/cmd_vel", "/bridge")]
    assert mismatched(twist("/cmd_vel", "[")) == expected
    assert mismatched(entries=ENTRIES.format("/cmd_vel", "GZ_TO_ROS")) == expected
    assert not mismatched(twist("/cmd_vel", "@"))


def test_the_clock_both_ways(mismatched):
    assert mismatched(CLOCK.format("@")) == [("/clock", "/clock", "/bridge")]
    assert not mismatched(CLOCK.format("["))


def test_what_the_robot_sends(mismatched):
    odometry = f"/model/bot/odom@{ODOMETRY.format('[')}"
    expected = [("/model/bot/odom", "/model/bot/odometry", "/bridge")]
    assert mismatched(odometry, twist("/cmd_vel")) == expected


def test_more_than_one_name_left_over_tells_nothing(mismatched):
    assert not mismatched(twist("/one"), twist("/two"))
    assert not mismatched(twist("/one"), library="gz-sim-odd-system")


def test_a_name_that_depends_on_the_world(mismatched):
    states = "/states@sensor_msgs/msg/JointState[gz.msgs.Model"
    library = "gz-sim-joint-state-publisher-system"
    assert not mismatched(states, library=library, elements="")
    assert mismatched(states, library=library, elements="<topic>joints</topic>") == [
        ("/states", "/joints", "/bridge")
    ]


SENSOR = """<topic>cmd_vel</topic></plugin></gazebo>
<gazebo reference="laser"><sensor name="eye" type="{}">{}</sensor></gazebo>
<gazebo><plugin filename="gz-sim-sensors-system" name="s">"""
SCAN = "{}@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"
SCOPED = "/world/hall/model/bot/link/base/sensor/eye/scan"


@pytest.mark.parametrize(
    ("topic", "bridged", "expected"),
    [
        ("<topic>r/scan</topic>", "/scan", [("/scan", "/r/scan", "/bridge")]),
        ("<topic>scan</topic>", "/scan", []),
        ("", "/scan", [("/scan", "/world/*/model/bot/link/*/sensor/eye/scan", "/bridge")]),
        ("", SCOPED, []),
        ("", "/truck/scan", []),
    ],
)
def test_a_bridge_past_a_sensor(mismatched, topic, bridged, expected):
    elements = SENSOR.format("gpu_lidar", topic)
    assert mismatched(SCAN.format(bridged), elements=elements) == expected


def test_a_sensor_whose_topics_are_not_known(mismatched):
    image = "/image@sensor_msgs/msg/Image[gz.msgs.Image"
    assert mismatched(image, elements=SENSOR.format("camera", "<topic>eye</topic>"))
    other = SENSOR.format("camera", "<topic>eye</topic></sensor><sensor type='segmentation'>")
    assert not mismatched(image, elements=other)


def test_a_camera_with_depth_sends_two_images(mismatched):
    elements = SENSOR.format("rgbd_camera", "<topic>eye</topic>")
    depth = "/eye/depth_image@sensor_msgs/msg/Image[gz.msgs.Image"
    assert not mismatched(depth, elements=elements)
    wrong = "/eye@sensor_msgs/msg/Image[gz.msgs.Image"
    assert mismatched(depth, wrong, elements=elements) == [("/eye", "/eye/image", "/bridge")]
