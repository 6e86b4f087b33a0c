"""Nodes of ROS 2 that are known without their source."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Direction

BRIDGE = '<launch><node pkg="ros_gz_bridge" exec="parameter_bridge" {given}</node></launch>'
TOPICS = """- topic_name: cmd_vel
  ros_type_name: geometry_msgs/msg/Twist
  gz_type_name: gz.msgs.Twist
  direction: ROS_TO_GZ
- ros_topic_name: /scan
  gz_topic_name: lidar
  ros_type_name: sensor_msgs/msg/LaserScan
  gz_type_name: gz.msgs.LaserScan
  direction: GZ_TO_ROS
- gz_topic_name: both
  ros_type_name: std_msgs/msg/Bool
  gz_type_name: gz.msgs.Boolean
"""


@pytest.fixture
def bridged(tmp_path):
    """Return what a bridge has that is launched with these attributes and parts."""
    top = tmp_path / "sim"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>sim</name></package>")
    (top / "bridge.yaml").write_text(TOPICS)

    def scan(given, launch=BRIDGE):
        (top / "app.launch.xml").write_text(launch.format(given=given))
        return scan_ros2_app([top], [(top / "app.launch.xml", {})], {}, ScanOptions(workers=1))

    return scan


def ends(graph):
    return {
        ("> " if e.direction is Direction.PUBLISH else "< ") + f"{e.topic} {e.type}"
        for e in graph.endpoints
        if not e.implicit
    }


def test_a_bridge_carries_what_its_file_says(bridged):
    graph = bridged(
        'namespace="r"><param name="config_file" value="$(find-pkg-share sim)/bridge.yaml"/>'
        '<param name="use_sim_time" value="true"/>'
    )
    assert [node.name for node in graph.nodes] == ["/r/ros_gz_bridge"]
    assert ends(graph) == CARRIED
    assert [e.node for e in graph.subscribers("/clock")] == ["/r/ros_gz_bridge"]
    assert graph.publishers("/scan")[0].evidence[1].file.endswith("bridge.yaml")
    assert graph.unresolved == ()


CARRIED = {
    "< /r/cmd_vel geometry_msgs/msg/Twist",
    "> /scan sensor_msgs/msg/LaserScan",
    "< /r/both std_msgs/msg/Bool",
    "> /r/both std_msgs/msg/Bool",
}
LOADED = """<launch><node_container pkg="rclcpp_components" exec="component_container" name="c"
  namespace=""><composable_node pkg="ros_gz_bridge" plugin="ros_gz_bridge::RosGzBridge" {given}
  </composable_node></node_container></launch>"""
IN_PARAMETERS = """<param name="bridge_names" value="[a, b]" type="list[str]"/>
<param name="bridges"><param name="{first}">
<param name="ros_topic_name" value="tool"/><param name="gz_topic_name" value="/world/tool"/>
<param name="ros_type_name" value="std_msgs/msg/Bool"/>
<param name="gz_type_name" value="gz.msgs.Boolean"/>
<param name="direction" value="ROS_TO_GZ"/></param></param>
<param name="bridges.b.topic_name" value="/clock"/>
<param name="bridges.b.ros_type_name" value="rosgraph_msgs/msg/Clock"/>"""


def test_a_bridge_is_a_component_too(bridged):
    given = 'namespace="r"><param name="config_file" value="$(find-pkg-share sim)/bridge.yaml"/>'
    graph = bridged(given, LOADED)
    assert "/r/ros_gz_bridge" in {node.name for node in graph.nodes}
    assert ends(graph) == CARRIED
    assert graph.unresolved == ()


def test_a_component_bridge_has_the_name_and_the_remaps_of_its_launch(bridged):
    given = 'name="b"><param name="config_file" value="$(find-pkg-share sim)/bridge.yaml"/>'
    graph = bridged(given + '<remap from="cmd_vel" to="moved"/>', LOADED)
    assert "/b" in {node.name for node in graph.nodes}
    assert "< /moved geometry_msgs/msg/Twist" in ends(graph)


@pytest.mark.parametrize("launch", [BRIDGE, LOADED])
def test_a_bridge_carries_what_its_parameters_say(bridged, launch):
    graph = bridged('namespace="r">' + IN_PARAMETERS.format(first="a"), launch)
    assert ends(graph) == {"< /r/tool std_msgs/msg/Bool"}
    (note,) = graph.unresolved
    assert note.why == "the bridge refuses an entry without ros_type_name and gz_type_name"


REPLACED = """from launch import LaunchDescription
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare
from nav2_common.launch import ReplaceString
def generate_launch_description():
    file = ReplaceString([FindPackageShare('sim'), '/named.yaml'], {'<robot>': 'r2'})
    return LaunchDescription([Node(package='ros_gz_bridge', executable='parameter_bridge',
        name='b', parameters=[{'config_file': file}])])
"""


def test_a_bridge_carries_what_the_launch_makes_of_a_file(bridged, tmp_path):
    top = tmp_path / "sim"
    (top / "named.yaml").write_text(TOPICS.replace("cmd_vel", "<robot>/cmd_vel"))
    (top / "app.launch.py").write_text(REPLACED)
    launches = [(top / "app.launch.py", {})]
    graph = scan_ros2_app([top], launches, {}, ScanOptions(workers=1))
    assert "< /r2/cmd_vel geometry_msgs/msg/Twist" in ends(graph)
    assert graph.unresolved == ()


def test_a_bridge_offers_services(bridged):
    graph = bridged(
        'name="b" args="/world/control@ros_gz_interfaces/srv/ControlWorld'
        ' /other@ros_gz_interfaces/srv/ControlWorld@gz.msgs.WorldControl@gz.msgs.Boolean">'
    )
    offered = {(s.name, s.type) for s in graph.services if not s.implicit}
    assert offered == {
        ("/world/control", "ros_gz_interfaces/srv/ControlWorld"),
        ("/other", "ros_gz_interfaces/srv/ControlWorld"),
    }
    assert ends(graph) == set()


REFUSED = {
    "- no entry": "without ros_type_name",
    "- {topic_name: a, ros_type_name: x/msg/A}": "without ros_type_name",
    "- {topic_name: a, gz_topic_name: b, ros_type_name: x/msg/A, gz_type_name: A}": "another name",
    "- {topic_name: a, ros_type_name: x/msg/A, gz_type_name: A, direction: BACK}": "direction BACK",
}


@pytest.mark.parametrize("entry", REFUSED)
def test_what_the_bridge_refuses_is_noted(bridged, tmp_path, entry):
    (tmp_path / "sim" / "odd.yaml").write_text(entry)
    graph = bridged('name="b"><param name="config_file" value="$(find-pkg-share sim)/odd.yaml"/>')
    assert ends(graph) == set()
    assert [REFUSED[entry] in note.why for note in graph.unresolved] == [True]


def test_a_bridge_carries_what_its_arguments_say_and_is_remapped(bridged):
    graph = bridged(
        'name="b" args="/a@std_msgs/msg/Bool[gz.msgs.Boolean c@std_msgs/msg/Bool]gz.msgs.Boolean">'
        '<remap from="c" to="moved"/>'
    )
    assert [node.name for node in graph.nodes] == ["/b"]
    assert ends(graph) == {"> /a std_msgs/msg/Bool", "< /moved std_msgs/msg/Bool"}


@pytest.mark.parametrize("file", ["/dev/null", "$(find-pkg-share sim)/none.yaml"])
def test_a_file_that_is_not_there_is_noted(bridged, file):
    graph = bridged(f'name="b"><param name="config_file" value="{file}"/>')
    assert ends(graph) == set()
    (note,) = graph.unresolved
    assert note.what == "topics of /b"
    assert "not in the folders" in note.why


def test_a_file_that_is_no_yaml_is_noted(bridged, tmp_path):
    (tmp_path / "sim" / "bad.yaml").write_text("- a\n- {b\n")
    graph = bridged('name="b"><param name="config_file" value="$(find-pkg-share sim)/bad.yaml"/>')
    assert "not YAML" in graph.unresolved[0].why
