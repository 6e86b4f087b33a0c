"""A guarded launch of ROS 2 one of whose nodes starts in a cell, in each kind of launch file."""

from dataclasses import replace
from xml.etree import ElementTree as ET

import pytest
import yaml
from plans import grcn, plan_of
from wrapped_launch import HEAD, launch

from rtron.errors import InputError
from rtron.planning.instrument import instrument_ros2, write_guarded_launch
from rtron.planning.instrument.common.cells import plan_cells
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.plan_file.writer import write_plan
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.vocabulary import InteractionGraph, Node

BASE = "/robot/base"
PLAN = replace(plan_of(grcn("/cmd_vel", ["/nav"], [BASE]), cell=(BASE,)), ros=2)
GRAPH = InteractionGraph(app="app", ros=2, nodes=(Node(name=BASE), Node(name="/nav")))
XML_BASE = '<node pkg="b" exec="b" name="base" namespace="robot" launch-prefix="nice"/>'
PYTHON_BASE = "Node(package='b', executable='y', name='base', namespace='robot')"
NAV = "Node(package='n', executable='x', name='nav')"


@pytest.fixture
def guard(tmp_path):
    """Return a function that guards a launch file whose base runs in a cell, and writes it."""

    def guarded(text, kind):
        app = tmp_path / f"app.launch.{kind}"
        app.write_text(text)
        tree = read_ros2_launch(app, {}, {}, {"pkg": tmp_path})
        out = tmp_path / "out" / f"guarded.launch.{kind}"
        cells = plan_cells(GRAPH, PLAN, ("--user", "driver"))
        files = GuardFiles(write_plan(PLAN), command=("g",))
        result = instrument_ros2(tree, PLAN, out, files, cells=cells)
        write_guarded_launch(result)
        return result

    return guarded


def test_an_xml_file_starts_the_base_alone_through_the_script_of_its_cell(guard):
    result = guard(f'<launch>{XML_BASE}<node pkg="n" exec="n" name="nav"/></launch>', "xml")
    nodes = [n for n in ET.parse(result.launch).getroot() if n.tag == "node"]
    prefix = f"$(var rtron_folder {result.folder})/cell_robot_base nice"
    assert [n.get("launch-prefix") for n in nodes] == [prefix, None]
    script = result.folder / "cell_robot_base"
    assert script.stat().st_mode & 0o111
    assert '--user driver -- "$@"' in script.read_text()
    assert (result.folder / "cell_robot_base.json").exists()
    assert any(note.startswith(f"{BASE} runs in a cell") for note in result.notes)


def test_a_yaml_file_starts_the_base_alone_through_the_script_of_its_cell(guard):
    text = (
        "launch:\n"
        "- node: {pkg: b, exec: b, name: base, namespace: robot}\n"
        "- node: {pkg: n, exec: n, name: nav}\n"
    )
    result = guard(text, "yaml")
    actions = yaml.safe_load(result.launch.read_text())["launch"]
    prefixes = [each["node"].get("launch-prefix") for each in actions if "node" in each]
    assert prefixes == [f"$(var rtron_folder {result.folder})/cell_robot_base", None]


def test_a_python_file_starts_the_base_alone_through_the_script_of_its_cell(guard):
    result = guard(HEAD.format(f"{NAV}, {PYTHON_BASE}"), "py")
    launched = launch(result.launch)
    first_words = [command[0] for command in launched["started"][1:]]
    assert first_words == ["/opt/ros/lib/n/x", str(result.folder / "cell_robot_base")]
    assert launched["told"] == []


def test_a_python_file_that_another_includes_starts_it_there_too(guard, tmp_path):
    (tmp_path / "base.launch.py").write_text(HEAD.format(PYTHON_BASE))
    text = f'<launch><include file="{tmp_path}/base.launch.py"/></launch>'
    result = guard(text, "xml")
    (copy,) = result.folder.glob("*_base.launch.py")
    (command,) = launch(copy)["started"]
    assert command[0] == str(result.folder / "cell_robot_base")


def test_a_base_whose_name_nobody_tells_is_reported_and_not_in_its_cell(guard):
    result = guard(HEAD.format("Node(package='b', executable='y')"), "py")
    launched = launch(result.launch)
    assert any(f"not started in their cells so far: {BASE}" in each for each in launched["told"])


def test_a_base_that_the_launch_does_not_start_is_refused(guard):
    with pytest.raises(InputError, match=f"this launch does not start {BASE}"):
        guard('<launch><node pkg="n" exec="n" name="nav"/></launch>', "xml")


def test_a_component_cannot_be_in_a_cell(guard):
    component = '<composable_node pkg="p" plugin="P" name="base" namespace="robot"/>'
    container = '<node_container pkg="c" exec="c" name="box" namespace="">{}</node_container>'
    with pytest.raises(InputError, match="is a component"):
        guard(f"<launch>{container.format(component)}</launch>", "xml")
    described = "ComposableNode(package='p', plugin='P', name='base', namespace='/robot')"
    loaded = (
        f"LoadComposableNodes(target_container='/box', composable_node_descriptions=[{described}])"
    )
    assert "is a component" in launch(guard(HEAD.format(loaded), "py").launch)["error"]
