"""`rtron scan --execute-launch`: a launch file is run where reading it leaves something open."""

import json
import sys
from pathlib import Path

import pytest
from ros2_robot import write_robot

DOUBLE = Path(__file__).parents[3] / "ros2" / "launch_double"
COMPUTED = """
import hashlib
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

OUT = '/drive_' + hashlib.sha1(b'robot').hexdigest()[:4]

def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('name', default_value='keyboard'),
        Node(package='keys', executable='teleop', name=LaunchConfiguration('name'),
             remappings=[('cmd_vel', OUT)]),
    ])
"""
LAUNCHED = ("--launch", "parts/computed.launch.py", "-j", "1")
EXECUTED = (*LAUNCHED, "--execute-launch", "--launch-python", sys.executable)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("PYTHONPATH", str(DOUBLE))
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    folder = write_robot(tmp_path / "src")
    (folder / "parts" / "launch").mkdir(exist_ok=True)
    (folder / "parts" / "launch" / "computed.launch.py").write_text(COMPUTED)
    return folder


def graph_of(ran):
    assert (ran.code, ran.err) == (0, "")
    return json.loads(ran.out)


def published(graph):
    return {(e["node"], e["topic"]) for e in graph["endpoints"] if e["direction"] == "publish"}


AS_GRAPH = ("--format", "graph", "--fail-on", "never")


def test_a_computed_name_is_known(rtron, folder):
    read = graph_of(rtron("scan", folder, *LAUNCHED, *AS_GRAPH))
    assert ("/keyboard", "/drive_b232") not in published(read)
    graph = graph_of(rtron("scan", folder, *EXECUTED, *AS_GRAPH))
    assert ("/keyboard", "/drive_b232") in published(graph)
    (node,) = [node for node in graph["nodes"] if node["name"] == "/keyboard"]
    assert node["origin"].endswith("computed.launch.py:13 (executed)")
    named = graph_of(rtron("scan", folder, *EXECUTED, *AS_GRAPH, "name:=other"))
    assert ("/other", "/drive_b232") in published(named)


def test_the_next_command_runs_it_too(rtron, folder):
    ran = rtron("scan", folder, *EXECUTED)
    assert "--execute-launch --launch-python" in " ".join(ran.out.split())


def test_a_plan_of_it(rtron, folder, tmp_path):
    plan = tmp_path / "rtron.yaml"
    ran = rtron("plan", folder, *EXECUTED, "-o", plan)
    assert (ran.code, ran.err) == (0, "")
    assert "topic: /drive_b232" in plan.read_text()


def test_a_launch_file_of_which_reading_tells_nothing(rtron, folder):
    launch = folder / "parts" / "launch" / "computed.launch.py"
    launch.write_text(f"text = {COMPUTED!r}\nexec(compile(text, __file__, 'exec'))\n")
    assert rtron("scan", folder, *LAUNCHED).code == 2
    graph = graph_of(rtron("scan", folder, *EXECUTED, *AS_GRAPH))
    assert ("/keyboard", "/drive_b232") in published(graph)


def test_an_argument_that_is_missing_is_said_before_anything_runs(rtron, folder, tmp_path):
    launch = folder / "parts" / "launch" / "computed.launch.py"
    text = COMPUTED.replace(", default_value='keyboard'", "")
    launch.write_text(f"open({str(tmp_path / 'mark')!r}, 'w')\n{text}")
    ran = rtron("scan", folder, *EXECUTED)
    assert (ran.code, "help: add name:=VALUE" in ran.err) == (2, True), ran.err
    assert not (tmp_path / "mark").exists()


def test_what_reading_explains_is_not_run(rtron, folder):
    known = folder / "parts" / "launch" / "computed.launch.py"
    known.write_text(COMPUTED.replace("hashlib.sha1(b'robot').hexdigest()[:4]", "'x'"))
    with_no_python = (*LAUNCHED, "--execute-launch", "--launch-python", "/no/python")
    graph = graph_of(rtron("scan", folder, *with_no_python, *AS_GRAPH))
    assert ("/keyboard", "/drive_x") in published(graph)
    assert not any("executed" in node["origin"] for node in graph["nodes"])


def test_without_the_option_nothing_is_run(rtron, folder, tmp_path):
    mark = tmp_path / "mark"
    launch = folder / "parts" / "launch" / "computed.launch.py"
    launch.write_text(f"open({str(mark)!r}, 'w')\n{COMPUTED}")
    graph_of(rtron("scan", folder, *LAUNCHED, *AS_GRAPH))
    assert not mark.exists()
    graph_of(rtron("scan", folder, *EXECUTED, *AS_GRAPH))
    assert mark.exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("SRC", *LAUNCHED, "--launch-python", "python3"), "without --execute-launch"),
        (("--live", "--execute-launch"), "--execute-launch without an app in source"),
        (("GRAPH", "--execute-launch"), "--execute-launch without an app in source"),
        (
            ("SRC", "--launch", "old/old.launch", "--execute-launch"),
            "--execute-launch is for launch files of ROS 2",
        ),
        (("SRC", *LAUNCHED, "--execute-launch"), "launch_ros is not installed in"),
    ],
)
def test_what_is_wrong_is_said(rtron, folder, graph_file, monkeypatch, words, said):
    (folder / "old").mkdir()
    (folder / "old" / "package.xml").write_text("<package><name>old</name></package>")
    (folder / "old" / "old.launch").write_text('<launch><node pkg="a" type="t" name="n"/></launch>')
    monkeypatch.delenv("PYTHONPATH")
    monkeypatch.setenv("PATH", "/no/folder")
    given = {"SRC": folder, "GRAPH": graph_file}
    ran = rtron("scan", *(given.get(word, word) for word in words))
    assert (ran.code, said in ran.err) == (2, True), ran.err


def test_an_exception_of_the_launch_file_is_told(rtron, folder):
    launch = folder / "parts" / "launch" / "computed.launch.py"
    launch.write_text(COMPUTED.replace("b'robot'", "None"))
    ran = rtron("scan", folder, *EXECUTED)
    assert (ran.code, f"{launch}:8: launch ends: TypeError" in ran.err) == (2, True), ran.err
    assert "help: without --execute-launch the file is read" in ran.err
