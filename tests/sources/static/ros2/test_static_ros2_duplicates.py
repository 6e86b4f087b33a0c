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
def repetition_notes(tmp_path):
    """Return what is noted on nodes where a file is included twice."""
    top = tmp_path / "robot"
    top.mkdir()
    (top / "package.xml").write_text("<package><name>robot</name></package>")

    def scan(part, before="", condition=""):
        (top / "part.launch.xml").write_text(f"<launch>{part}</launch>")
        (top / "app.launch.xml").write_text(TWICE.format(before, condition))
        one = ScanOptions(workers=1)
        graph = scan_ros2_app([top], [(top / "app.launch.xml", {})], {}, one)
        return [(n.what, n.why) for n in graph.unresolved if n.what.startswith("node ")]

    return scan


@pytest.mark.parametrize("name", ["", 'name="keys"'])
def test_a_node_that_two_includes_start_is_noted(repetition_notes, name):
    ((what, why),) = repetition_notes(NODE.format(name))
    assert what == ("node /keys" if name else "node /teleop_twist_keyboard")
    assert why.startswith("started 2 times")


def test_a_node_whose_name_is_another_each_time_is_not(repetition_notes):
    assert repetition_notes(NODE.format('name="$(var which)"')) == []
    assert repetition_notes(NODE.format('namespace="$(var which)"')) == []
    assert repetition_notes(LOAD) == []


def test_a_node_that_may_start_once_only_is_not(repetition_notes):
    unknown = '<let name="both" value="$(command date)"/>'
    assert repetition_notes(NODE.format(""), unknown, ' if="$(var both)"') == []


def test_a_node_that_names_itself_at_random_is_not(repetition_notes):
    frames = 'pkg="tf2_ros" exec="static_transform_publisher"'
    assert repetition_notes(f'<node {frames} args="0 0 0 0 0 0 a b"/>') == []


def test_what_it_calls_itself_is_said_and_remaps_tell_it_apart(repetition_notes):
    joy = '<node pkg="joy_linux" exec="joy_linux_node"{}</node>'
    assert [what for what, _ in repetition_notes(joy.format(">"))] == ["node /joy_node"]
    assert repetition_notes(joy.format('><remap from="joy" to="$(var which)"/>')) == []
