"""`rtron scan` and `rtron plan` of an app of ROS 2 in source."""

import json
import shlex
import subprocess

import pytest
from ros2_robot import write_robot


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    return write_robot(tmp_path / "src")


def test_a_folder_alone_lists_launch_files_of_each_format(rtron, folder):
    ran = rtron("scan", folder)
    assert (ran.code, ran.err) == (0, "")
    assert "4 launch files" in ran.out
    assert "parts/more.launch.xml    kind:=…" in ran.out
    assert "parts/robot.launch.py    [out:=…]" in ran.out
    assert "parts/robot.launch.yaml  [out:=…]" in ran.out
    assert "parts/robot.launch.xml   [out:=…]" in ran.out


def test_a_folder_may_have_launch_files_of_both_generations(rtron, folder):
    (folder / "old").mkdir()
    (folder / "old" / "package.xml").write_text("<package><name>old</name></package>")
    old = '<launch><arg name="a"/><node pkg="old" type="t" name="n"/></launch>'
    (folder / "old" / "old.launch.xml").write_text(old)
    listed = json.loads(rtron("scan", folder, "--format", "json").out)["launches"]
    assert {one["launch"]: one["required"] for one in listed}["old/old.launch.xml"] == ["a"]
    assert len(listed) == 5
    both = ("--launch", "old/old.launch.xml", "--launch", "parts/robot.launch.py")
    ran = rtron("scan", folder, *both)
    assert ran.code == 2
    assert "old.launch.xml is of ROS 1 and robot.launch.py of ROS 2" in ran.err
    assert "help: scan the two apps apart" in ran.err


def test_a_package_in_a_package_is_a_part_of_it(rtron, folder):
    inner = folder / "keys" / "tests" / "inner"
    (inner / "launch").mkdir(parents=True)
    (inner / "package.xml").write_text("<package><name>inner</name></package>")
    text = '<launch><arg name="a"/><let name="b" value=""/></launch>'
    (inner / "launch" / "in.launch.xml").write_text(text)
    assert "keys/in.launch.xml" in rtron("scan", folder).out
    ran = rtron("scan", folder, "--launch", "keys/in.launch.xml", "a:=1", "--fail-on", "never")
    assert (ran.code, ran.err) == (0, "")


def test_a_scan_is_of_ros_2_and_takes_arguments(rtron, folder):
    app = ("--launch", "parts/robot.launch.py", "out:=/drive", "-j", "1")
    ran = rtron("scan", folder, *app, "--format", "graph", "--fail-on", "never")
    graph = json.loads(ran.out)
    assert (ran.code, graph["ros"]) == (0, 2)
    published = {(e["node"], e["topic"]) for e in graph["endpoints"] if e["direction"] == "publish"}
    assert {("/robot/smooth", "/drive"), ("/robot/pad", "/robot/cmd_vel_nav")} <= published


@pytest.mark.parametrize("ending", ["py", "xml", "yaml"])
def test_a_launch_file_as_path_is_read_with_its_package(rtron, folder, ending):
    (path,) = folder.glob(f"**/robot.launch.{ending}")
    ran = rtron("scan", path, "-j", "1", "--format", "graph", "--fail-on", "never")
    assert (ran.code, ran.err, json.loads(ran.out)["ros"]) == (0, "", 2)
    assert "/robot/smooth" in ran.out


def test_a_python_file_is_a_launch_file_by_what_it_defines(rtron, folder):
    (path,) = folder.glob("**/robot.launch.py")
    ran = rtron("plan", path.rename(path.with_name("bringup.py")), "-j", "1", "-o", "-")
    assert (ran.code, "ros: 2" in ran.out) == (0, True)


def test_the_next_steps_guard_several_launch_files_by_one(rtron, folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    launches = ("--launch", "parts/robot.launch.py", "--launch", "parts/robot.launch.xml out:=/o")
    ran = rtron("plan", folder, *launches, "-j", "1", "-o", "rtron.yaml")
    write, instrument = ran.out.partition("\nNext\n")[2].splitlines()
    subprocess.run(["/bin/sh", "-c", write], check=True)
    one, other = json.loads((tmp_path / "all.launch.yaml").read_text())["launch"]
    assert "arg" not in one["group"][0]["include"]
    assert other["group"][0]["include"]["arg"] == [{"name": "out", "value": "/o"}]
    assert rtron(*shlex.split(instrument)[1:]).code == 0
    guarded = (tmp_path / "guarded.launch.yaml").read_text()
    assert guarded.count("robot.launch") == 2
    assert "rtron_guard" in guarded


def test_a_plan_follows(rtron, folder, tmp_path):
    plan = tmp_path / "rtron.yaml"
    app = ("--launch", "parts/robot.launch.py", "-j", "1")
    assert rtron("plan", folder, *app, "-o", plan).code == 0
    assert "ros: 2" in plan.read_text()


def test_what_is_missing_is_said_with_what_to_do(rtron, folder):
    ran = rtron("scan", folder, "--launch", "parts/more.launch.xml")
    assert ran.code == 2
    assert "argument 'kind' is not given" in ran.err
    assert "help: add kind:=VALUE" in ran.err
    ran = rtron("scan", folder, "--launch", "parts/robt.launch.py")
    assert (ran.code, "did you mean parts/robot.launch.py" in ran.err) == (2, True)


@pytest.mark.parametrize("linked", [False, True])
def test_a_launch_file_of_an_installed_package_is_named_by_it(rtron, folder, tmp_path, linked):
    share = tmp_path / "install" / "share" / "bringup"
    (share / "launch").mkdir(parents=True)
    text = """from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    return LaunchDescription([IncludeLaunchDescription(
        [FindPackageShare('bringup'), '/launch/pad.launch.xml'])])
"""
    inner = '<launch><node pkg="keys" exec="teleop" name="pad"/></launch>'
    places = share / "launch", tmp_path / "elsewhere"
    places[1].mkdir()
    for name, written in (("all.launch.py", text), ("pad.launch.xml", inner)):
        (places[linked] / name).write_text(written)
        if linked:
            (places[0] / name).symlink_to(places[1] / name)
    prefixes = f"AMENT_PREFIX_PATH={tmp_path / 'none'}:{tmp_path / 'install'}"
    app = ("--launch", "bringup/all.launch.py", "--env", prefixes, "-j", "1", "--format", "graph")
    ran = rtron("scan", folder, *app, "--fail-on", "never")
    assert (ran.code, ran.err) == (0, "")
    assert [node["name"] for node in json.loads(ran.out)["nodes"]] == ["/pad"]


@pytest.mark.parametrize("spelled", ["../x.launch.py", "./x.launch.py", "gone/x.launch.py"])
def test_what_is_no_package_is_not_looked_for_where_packages_are(rtron, folder, tmp_path, spelled):
    (tmp_path / "install" / "share" / "inner").mkdir(parents=True)
    (tmp_path / "install" / "x.launch.py").write_text("")
    prefix = f"AMENT_PREFIX_PATH={tmp_path / 'install'}"
    ran = rtron("scan", folder, "--launch", spelled, "--env", prefix)
    assert (ran.code, "no launch file" in ran.err) == (2, True)


ENVIRONMENT_LAUNCH = """import os
from launch import LaunchDescription
from launch.substitutions import EnvironmentVariable
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(package="parts", executable="x", name=os.environ["MODEL"]),
        Node(package="parts", executable="x", name=os.environ.get("LIDAR", "ld08")),
        Node(package="parts", executable="x", name=EnvironmentVariable("ARM", default_value="no")),
    ])
"""


def test_python_launch_files_get_the_variables_that_are_given(rtron, folder, monkeypatch):
    (folder / "parts" / "launch" / "env.launch.py").write_text(ENVIRONMENT_LAUNCH)
    for name in ("MODEL", "LIDAR", "ARM"):
        monkeypatch.setenv(name, f"my_{name.lower()}")
    app = ("scan", folder, "--launch", "parts/env.launch.py", "-j", "1", "--fail-on", "never")

    def names(*words):
        document = json.loads(rtron(*app, *words, "--format", "graph").out)
        return {node["name"] for node in document["nodes"]}

    assert {"/ld08", "/no"} <= names()
    assert names("--env-all") == {"/my_model", "/my_lidar", "/my_arm"}
    assert names("--env", "MODEL", "--env", "LIDAR=a", "--env", "ARM") == {
        "/my_model",
        "/a",
        "/my_arm",
    }
    said = " ".join(rtron(*app).out.split())
    assert "not given: environment variables" in said
    assert all(name in said for name in ("MODEL", "LIDAR", "ARM"))


SKIPPED = {
    "argument": '<arg name="robot" default="a" if="$(var sim)"/>',
    "group": '<group if="$(var sim)"><arg name="robot" default="a"/></group>',
    "include": '<include file="$(find-pkg-share parts)/launch/other.launch.xml" if="false"/>',
    "absent": '<include file="$(find-pkg-share absent)/launch/other.launch.xml"/>',
    "unknown": '<mystery robot="a"/>',
}


@pytest.mark.parametrize("part", SKIPPED.values(), ids=SKIPPED)
def test_an_argument_that_may_be_declared_in_what_is_skipped_is_not_missed(rtron, folder, part):
    text = f'<launch><arg name="sim" default="false"/>{part}</launch>'
    (folder / "parts" / "launch" / "part.launch.xml").write_text(text)
    app = ("--launch", "parts/part.launch.xml", "-j", "1", "--fail-on", "never")
    ran = rtron("scan", folder, *app, "robot:=b", "sin:=true", "--format", "graph")
    whats = [note["what"] for note in json.loads(ran.out)["unresolved"]]
    assert "launch argument robot" not in whats
    assert "launch argument sin" in whats


def test_a_distribution_that_nothing_names_is_said(rtron, folder):
    app = ("scan", folder, "--launch", "parts/robot.launch.py", "-j", "1", "--fail-on", "never")
    said = "nothing names the ROS distribution: the newest counts"
    assert said in " ".join(rtron(*app).out.split())
    assert said not in " ".join(rtron(*app, "--env", "ROS_DISTRO=jazzy").out.split())


def test_only_a_distribution_that_is_given_is_a_fact(rtron, folder):
    app = ("scan", folder, "--launch", "parts/robot.launch.py", "-j", "1", "--fail-on", "never")

    def named(*words):
        wiring = json.loads(rtron(*app, *words, "--format", "graph").out)["wiring"]
        return [fact["subject"] for fact in wiring if fact["kind"] == "distribution"]

    assert named("--env", "ROS_DISTRO=humble") == ["humble"]
    (folder / "Dockerfile").write_text("FROM ros:humble\n")
    assert named() == []
