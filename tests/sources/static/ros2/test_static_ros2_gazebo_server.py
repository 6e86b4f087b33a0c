"""Gazebo's server as a launch of ROS 2 starts it: its system plugins, and what its world holds."""

import pytest
from file_tree import write

from rtron.errors import InputError
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app
from rtron.vocabulary import Direction

WORLD = """<sdf version="1.6"><world name="w">
  <plugin name="state" filename="libgazebo_ros_state.so">
    <ros><namespace>/sim</namespace></ros></plugin>
  <plugin name="odd" filename="libodd.so"/>
  <include><uri>model://sun</uri></include>
  <include><uri>model://bot</uri></include>
</world></sdf>"""
BOT = """<!-- A robot. --> <!-- Its wheels turn. -->
<?xml version="1.0"?>
<sdf version="1.6"><model name="bot">
  <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
    <publish_odom>1</publish_odom></plugin>
</model></sdf>"""
INIT = "-s libgazebo_ros_init.so"


@pytest.fixture
def simulated(tmp_path):
    """Return the graph of an app that starts a server with some words."""
    top = tmp_path / "app"
    write(
        top,
        {
            "package.xml": "<package><name>app</name></package>",
            "worlds/app.world": WORLD,
            "models/bot/model.sdf": BOT,
        },
    )
    (tmp_path / "outside.world").write_text(WORLD)
    launch = top / "app.launch.xml"

    def scan(*commands, environ=None):
        started = "".join(f"<executable cmd='{command}'/>" for command in commands)
        launch.write_text(f"<launch>{started}</launch>")
        return scan_ros2_app([top], [(launch, {})], environ or {}, ScanOptions(workers=1))

    return scan


def ends(graph, node):
    topics = {
        ("> " if e.direction is Direction.PUBLISH else "< ") + e.topic
        for e in graph.endpoints
        if e.node == node and not e.implicit
    }
    return topics | {s.name for s in graph.services if s.node == node and not s.implicit}


@pytest.mark.parametrize("program", ["gzserver", "/usr/bin/gazebo --verbose"])
def test_system_plugins_share_a_node(simulated, program):
    graph = simulated(f"{program} {INIT} --server-plugin=libgazebo_ros_factory.so", "gzclient")
    assert [node.name for node in graph.nodes] == ["/gazebo"]
    assert "> /clock" in ends(graph, "/gazebo")
    assert {"/pause_physics", "/spawn_entity"} <= ends(graph, "/gazebo")
    assert "/apply_link_wrench" not in ends(graph, "/gazebo")
    assert graph.unresolved == ()


def test_plugins_of_the_world_and_of_its_models_are_nodes(simulated):
    graph = simulated(f"gzserver $(find-pkg-share app)/worlds/app.world {INIT}")
    assert [node.name for node in graph.nodes] == ["/gazebo", "/sim/state", "/drive"]
    assert {"> /sim/model_states", "/sim/set_entity_state"} <= ends(graph, "/sim/state")
    assert ends(graph, "/drive") == {"< /cmd_vel", "> /odom"}
    assert graph.endpoints[-1].topic == "/clock"
    (odom,) = graph.publishers("/odom")
    assert (odom.evidence[0].file[-13:], odom.evidence[0].line) == ("bot/model.sdf", 4)
    assert [note.what for note in graph.unresolved] == ["Gazebo plugin odd"]


def test_a_world_is_looked_for_where_the_user_says(simulated, tmp_path):
    worlds = {"GAZEBO_RESOURCE_PATH": str(tmp_path / "app" / "worlds")}
    assert "/drive" in {n.name for n in simulated("gzserver app.world", environ=worlds).nodes}
    (note,) = simulated("gzserver -e ode app.world").unresolved
    assert (note.what, note.why) == ("world app.world", "is not found in the folders that are read")


def test_a_world_outside_of_the_workspace_is_not_read(simulated, tmp_path):
    graph = simulated(f"gzserver {tmp_path}/outside.world {INIT}")
    assert [node.name for node in graph.nodes] == ["/gazebo"]
    assert [note.why for note in graph.unresolved] == ["is not found in the folders that are read"]


def test_a_world_is_looked_for_where_a_package_hooks_it_in(simulated, tmp_path):
    hooks = tmp_path / "app" / "env-hooks"
    hooks.mkdir()
    lines = "set;A;b\nprepend-non-duplicate;GAZEBO_RESOURCE_PATH;share/@PROJECT_NAME@/{}\n"
    (hooks / "app.dsv.in").write_text(lines.format("worlds"))
    assert "/drive" in {node.name for node in simulated("gzserver app.world").nodes}
    (hooks / "app.dsv.in").write_text(lines.format("../../.."))
    assert not simulated("gzserver app.world").nodes
    (hooks / "app.dsv.in").write_text(lines.format("worlds").replace("RESOURCE", "PLUGIN"))
    assert not simulated("gzserver app.world").nodes


INCLUDE = """<launch><include file="$(find-pkg-share gazebo_ros)/launch/{name}.launch.py">
  <arg name="world" value="{world}"/><arg name="{plugin}" value="false"/></include></launch>"""


@pytest.mark.parametrize("name", ["gazebo", "gzserver"])
def test_gazebo_ros_is_included_though_it_is_not_here(simulated, tmp_path, name):
    launch = tmp_path / "app" / "include.launch.xml"
    world = "$(find-pkg-share app)/worlds/app.world"
    launch.write_text(INCLUDE.format(name=name, world=world, plugin="force_system"))
    graph = scan_ros2_app([tmp_path / "app"], [(launch, {})], {}, ScanOptions(workers=1))
    assert [node.name for node in graph.nodes] == ["/gazebo", "/sim/state", "/drive"]
    services = ends(graph, "/gazebo")
    assert "/spawn_entity" in services
    assert "/apply_link_wrench" not in services
    assert [note.what for note in graph.unresolved] == ["Gazebo plugin odd"]


def test_the_empty_world_of_gazebo_ros_has_no_plugin(simulated, tmp_path):
    launch = tmp_path / "app" / "include.launch.xml"
    world = "$(find-pkg-share gazebo_ros)/worlds/empty.world"
    launch.write_text(INCLUDE.format(name="gazebo", world=world, plugin="factory"))
    graph = scan_ros2_app([tmp_path / "app"], [(launch, {})], {}, ScanOptions(workers=1))
    assert "/apply_link_wrench" in ends(graph, "/gazebo")
    assert graph.unresolved == ()


def test_another_launch_of_gazebo_ros_is_noted(simulated, tmp_path):
    launch = tmp_path / "app" / "include.launch.xml"
    launch.write_text(INCLUDE.format(name="other", world="", plugin="init"))
    why = r"not known: \{find-pkg-share gazebo_ros\}/launch/other.launch.py"
    with pytest.raises(InputError, match=why):
        scan_ros2_app([tmp_path / "app"], [(launch, {})], {}, ScanOptions(workers=1))
