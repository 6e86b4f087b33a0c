"""A guarded launch whose processes start in their enclaves, in each kind of launch file."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import yaml
from wrapped_launch import HEAD, launch

from rtron.planning.instrument import instrument_ros2, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.planning.instrument.ros2.enclaves import Enclaves
from rtron.planning.plan_file.loader import parse_plan
from rtron.sources.launch.ros2.reader import read_ros2_launch

PLAN = """\
schema: rtron.plan/1
app: a
ros: 2
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Block
    flows:
      - {name: teleop, publisher: /teleop}
    successors: [/base]
"""
PREFIX = "$(var rtron_folder {folder})/enclave"
VARIABLES = {
    "ROS_SECURITY_ENABLE": "true",
    "ROS_SECURITY_STRATEGY": "Enforce",
    "ROS_SECURITY_KEYSTORE": "/keys",
}


@pytest.fixture
def guard(tmp_path):
    """Return a function that guards a launch file for a keystore, and writes it."""

    def guarded(text, kind):
        app = tmp_path / f"app.launch.{kind}"
        app.write_text(text)
        tree = read_ros2_launch(app, {}, {}, {"pkg": tmp_path})
        enclaves = Enclaves(
            keystore=Path("/keys"),
            of_nodes={"/teleop_*": "/any", "/teleop": "/teleop", "/base": "/base"},
            of_programs={"o/o": "/o"},
        )
        out = tmp_path / "out" / f"guarded.launch.{kind}"
        files = GuardFiles(PLAN, command=("g",))
        result = instrument_ros2(tree, parse_plan(PLAN), out, files, enclaves)
        write_guarded_launch(result)
        return result

    return guarded


def test_an_xml_file_starts_every_process_through_the_script(guard):
    nodes = """
      <node pkg="t" exec="teleop_key" name="teleop"/>
      <node pkg="b" exec="b" name="base" launch-prefix="nice -n 5" exec_name="motor"/>
      <node_container pkg="c" exec="c" name="box" namespace="">
        <composable_node pkg="p" plugin="P" name="part"/>
      </node_container>
      <node pkg="o" exec="o"/>
    """
    result = guard(f"<launch>{nodes}</launch>", "xml")
    root = ET.parse(result.launch).getroot()
    prefix = PREFIX.format(folder=result.folder)
    found = [(n.get("launch-prefix"), n.get("exec_name")) for n in root if "node" in n.tag]
    assert found == [
        (prefix, "teleop_key"),
        (f"{prefix} nice -n 5", "motor"),
        (prefix, "c"),
        (prefix, "o"),
    ]
    assert root.find(".//composable_node").get("launch-prefix") is None
    assert {e.get("name"): e.get("value") for e in root if e.tag == "set_env"} == VARIABLES


def test_the_guard_starts_before_the_prefix_is_in_force(guard):
    result = guard('<launch><node pkg="o" exec="o"/></launch>', "xml")
    first = [(e.tag, e.get("name")) for e in ET.parse(result.launch).getroot()]
    assert first[3:7] == [
        ("let", "rtron_folder"),
        ("include", None),
        ("executable", "rtron_guard"),
        ("let", "launch-prefix"),
    ]


def test_a_yaml_file_starts_every_process_through_the_script(guard):
    text = """\
launch:
- node: {pkg: t, exec: teleop_key, name: teleop}
- node:
    pkg: b
    exec: b
    name: base
    launch-prefix: nice -n 5
"""
    result = guard(text, "yaml")
    actions = yaml.safe_load(result.launch.read_text())["launch"]
    nodes = [each["node"] for each in actions if "node" in each]
    prefix = PREFIX.format(folder=result.folder)
    assert [n["launch-prefix"] for n in nodes] == [prefix, f"{prefix} nice -n 5"]
    assert [n["exec_name"] for n in nodes] == ["teleop_key", "b"]
    variables = [each["set_env"] for each in actions if "set_env" in each]
    assert {each["name"]: each["value"] for each in variables} == VARIABLES
    assert actions[6] == {"let": {"name": "launch-prefix", "value": "$(var rtron_folder)/enclave"}}


def test_a_python_file_starts_every_process_but_the_guard_through_the_script(guard):
    body = (
        "Node(package='t', executable='x', name='teleop', prefix='nice'), "
        "ExecuteProcess(cmd=['ls']), Node(package='b', executable='y', name='base')"
    )
    result = guard(HEAD.format(body), "py")
    started = launch(result.launch)["started"]
    script = str(result.folder / "enclave")
    assert [command[0] for command in started] == [str(result.folder / "guard"), *3 * [script]]
    assert started[1][1] == "nice"
    assert [command.count(script) for command in started] == [0, 1, 1, 1]


def test_names_go_before_patterns_in_the_table(guard):
    result = guard(HEAD.format(""), "py")
    assert (result.folder / "enclaves").read_text().splitlines() == [
        "node /base /base",
        "node /teleop /teleop",
        "node /teleop_* /any",
        "program o/o /o",
    ]
    assert (result.folder / "enclave").stat().st_mode & 0o111


def test_without_a_keystore_nothing_of_it_is_there(tmp_path):
    app = tmp_path / "app.launch.xml"
    app.write_text('<launch><node pkg="t" exec="t" name="teleop"/></launch>')
    tree = read_ros2_launch(app, {}, {}, {})
    out = tmp_path / "out.launch.xml"
    result = instrument_ros2(tree, parse_plan(PLAN), out, GuardFiles(PLAN, command=("g",)))
    assert "enclave" not in "".join(result.files.values())
    assert "SECURITY" not in "".join(result.files.values())
