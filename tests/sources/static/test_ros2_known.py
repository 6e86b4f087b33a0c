"""Nodes of ROS 2 that are known without their source."""

import pytest

from rtron.sources.static.options import ScanOptions
from rtron.sources.static.ros2_app import scan_ros2_app
from rtron.vocabulary import Direction

BRIDGE = '<launch><node pkg="ros_gz_bridge" exec="parameter_bridge" {given}</node></launch>'
TOPICS = """- topic_name: cmd_vel
  ros_type_name: geometry_msgs/msg/Twist
  gz_type_name: gz.msgs.Twist
  direction: ROS_TO_GZ
- ros_topic_name: /scan
  gz_topic_name: lidar
  ros_type_name: sensor_msgs/msg/LaserScan
  direction: GZ_TO_ROS
- gz_topic_name: both
  ros_type_name: std_msgs/msg/Bool
- not an entry
"""


@pytest.fixture
def bridged(tmp_path):
    """Return what a bridge has that is launched with these attributes and parts."""
    top = tmp_path / "sim"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>sim</name></package>")
    (top / "bridge.yaml").write_text(TOPICS)

    def scan(given):
        (top / "app.launch.xml").write_text(BRIDGE.format(given=given))
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
    assert ends(graph) == {
        "< /r/cmd_vel geometry_msgs/msg/Twist",
        "> /scan sensor_msgs/msg/LaserScan",
        "< /r/both std_msgs/msg/Bool",
        "> /r/both std_msgs/msg/Bool",
    }
    assert [e.node for e in graph.subscribers("/clock")] == ["/r/ros_gz_bridge"]
    assert graph.publishers("/scan")[0].evidence[1].file.endswith("bridge.yaml")
    assert graph.unresolved == ()


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
