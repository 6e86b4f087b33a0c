"""One line of a launch that starts the same node more than once."""

import pytest

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

NODE = '<node pkg="teleop_twist_keyboard" exec="teleop_twist_keyboard" {}/>'
LOAD = '<node pkg="controller_manager" exec="spawner" args="$(var which)"/>'
TWICE = """<launch>{}
  <include file="$(find-pkg-share robot)/part.launch.xml"><arg name="which" value="a"/></include>
  <group{}>
  <include file="$(find-pkg-share robot)/part.launch.xml"><arg name="which" value="b"/></include>
  </group>
</launch>"""


@pytest.fixture
def repeated_nodes(tmp_path):
    """Return the nodes that start more than once where a file is included twice."""
    top = tmp_path / "robot"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>robot</name></package>")

    def scan(part, before="", condition=""):
        (top / "part.launch.xml").write_text(f"<launch>{part}</launch>")
        (top / "app.launch.xml").write_text(TWICE.format(before, condition))
        one = ScanOptions(workers=1)
        graph = scan_ros2_app([top], [(top / "app.launch.xml", {})], {}, one)
        return [fact.subject for fact in graph.wiring if fact.kind == "duplicate_node"]

    return scan


@pytest.mark.parametrize("name", ["", 'name="keys"'])
def test_a_node_that_two_includes_start_is_noted(repeated_nodes, name):
    expected = "/keys" if name else "/teleop_twist_keyboard"
    assert repeated_nodes(NODE.format(name)) == [expected]


def test_a_node_whose_name_is_another_each_time_is_not(repeated_nodes):
    assert repeated_nodes(NODE.format('name="$(var which)"')) == []
    assert repeated_nodes(NODE.format('namespace="$(var which)"')) == []
    assert repeated_nodes(LOAD) == []
    for name in ("__node", "__ns"):
        remap = f'><remap from="{name}" to="/$(var which)"/></node>'
        assert repeated_nodes(NODE.format("").replace("/>", remap)) == []


def test_a_node_that_may_start_once_only_is_not(repeated_nodes):
    unknown = '<let name="both" value="$(command date)"/>'
    assert repeated_nodes(NODE.format(""), unknown, ' if="$(var both)"') == []


def test_a_node_that_names_itself_at_random_is_not(repeated_nodes):
    frames = 'pkg="tf2_ros" exec="static_transform_publisher"'
    assert repeated_nodes(f'<node {frames} args="0 0 0 0 0 0 a b"/>') == []


def test_what_it_calls_itself_is_said_whatever_its_remaps(repeated_nodes):
    joy = '<node pkg="joy_linux" exec="joy_linux_node"{}</node>'
    assert repeated_nodes(joy.format(">")) == ["/joy_node"]
    assert repeated_nodes(joy.format('><remap from="joy" to="$(var which)"/>')) == ["/joy_node"]


def test_remaps_tell_apart_what_may_call_itself_as_it_likes(repeated_nodes):
    remap = '<remap from="joy" to="$(var which)"/>'
    unread = f'<node pkg="nowhere" exec="gone"{{}}>{remap}</node>'
    assert repeated_nodes(unread.format("")) == []
    assert repeated_nodes(unread.format(' name="keys"')) == ["/keys"]


def test_nodes_on_conditions_that_are_not_known_may_exclude_each_other(repeated_nodes):
    either = '<let name="sim" value="$(command date)"/>'
    nodes = "\n".join(f'<node pkg="{name}" exec="x" name="base" {{}}/>' for name in "ab")
    assert repeated_nodes(NODE.format(""), nodes.format("", "")).count("/base") == 1
    conditions = ('if="$(var sim)"', 'unless="$(var sim)"')
    assert "/base" not in repeated_nodes(NODE.format(""), either + nodes.format(*conditions))
