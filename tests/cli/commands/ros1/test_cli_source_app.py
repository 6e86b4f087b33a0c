import json
import shlex
import shutil
import subprocess
import sys
from types import SimpleNamespace

import pytest
from file_tree import write

from rtron.cli.support.options import complete_launch
from rtron.sources.declaration import NodeSite
from rtron.sources.models import Model, node_interface
from rtron.sources.models.common.yaml_model import read_model
from rtron.vocabulary import Evidence, Parameter, ParameterTree

LAUNCH = """<launch><arg name="speed"/><arg name="topic" default="cmd_vel"/>
<node pkg="robot" type="drive.py" name="a"><remap from="cmd_vel" to="$(arg topic)"/></node>
<node pkg="robot" type="drive.py" name="b"/>
<node pkg="robot" type="base.py" name="base"/>
<node pkg="robot" type="$(env KIND).py" name="kind" args="$(arg speed)"/>
</launch>"""
ONE = """<launch><arg name="name"/>
<node pkg="robot" type="drive.py" name="a" args="$(arg name)"/></launch>"""
PLAIN = '<launch><node pkg="robot" type="base.py" name="base"/></launch>'
DRIVE = """#!/usr/bin/env python
import rospy
from geometry_msgs.msg import Twist
rospy.Publisher("cmd_vel", Twist, queue_size=1)
"""
BASE = DRIVE.replace('Publisher("cmd_vel", Twist, queue_size=1)', 'Subscriber("cmd_vel", Twist)')
FILES = {
    "package.xml": "<package><name>robot</name></package>",
    "CMakeLists.txt": "project(robot)",
    "launch/app.launch": LAUNCH,
    "launch/plain.launch": PLAIN,
    "launch/broken.launch": "<launch>",
    "scripts/drive.py": DRIVE,
    "scripts/base.py": BASE,
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    write(tmp_path / "robot", FILES)
    return tmp_path / "robot"


APP = ("--launch", "robot/app.launch", "--env", "KIND=base", "-j", "1")


def test_a_folder_alone_lists_its_launch_files(rtron, folder):
    ran = rtron("scan", folder)
    assert (ran.code, ran.err) == (0, "")
    assert "3 launch files" in ran.out
    assert "robot/app.launch     speed:=… [topic:=…]" in ran.out
    assert "robot/broken.launch  cannot be read" in ran.out
    assert f"rtron scan {folder} --launch robot/plain.launch" in ran.out


def test_what_a_build_made_is_not_read(rtron, folder):
    share = folder.parent / "install" / "robot" / "share"
    shutil.copytree(folder / "launch", share / "robot" / "launch")
    shutil.copy(folder / "package.xml", share / "robot")
    (folder.parent / "install" / "COLCON_IGNORE").touch()
    listed = rtron("scan", folder.parent)
    assert "3 launch files" in listed.out
    assert "robot/plain.launch" in listed.out
    app = ("--launch", "robot/plain.launch", "-j", "1")
    ends = graph(rtron, folder.parent, *app)["endpoints"]
    assert [end["evidence"][0]["file"] for end in ends] == [str(folder / "scripts" / "base.py")]


@pytest.mark.parametrize("app", [(), APP])
def test_a_folder_that_builds_leave_out_is_no_app(rtron, folder, app):
    (folder / "COLCON_IGNORE").touch()
    ran = rtron("scan", folder, *app)
    assert ran.code == 2
    assert f"{folder}: left out, as COLCON_IGNORE in it says" in ran.err
    assert "help: give the folder with the source" in ran.err


def test_the_launch_file_that_is_likeliest_to_start_the_app_is_proposed(rtron, folder):
    for name in ("a_teleop", "navigation", "zz_bringup"):
        (folder / "launch" / f"{name}.launch").write_text(PLAIN)
    assert "--launch robot/zz_bringup.launch\n" in rtron("scan", folder).out


def test_the_list_as_json(rtron, folder):
    document = json.loads(rtron("scan", folder, "--format", "json").out)
    assert document["schema"] == "rtron.launches/1"
    app, broken, plain = document["launches"]
    assert (app["launch"], app["required"], app["optional"]) == (
        "robot/app.launch",
        ["speed"],
        ["topic"],
    )
    assert (bool(broken["error"]), plain["error"]) == (True, "")


def test_an_app_in_source_is_scanned(rtron, folder):
    ran = rtron("scan", folder, *APP, "speed:=1")
    assert (ran.code, ran.err) == (1, "")
    assert "/cmd_vel" in ran.out
    words = f"rtron plan {folder} speed:=1 --launch robot/app.launch --env KIND=base -o rtron.yaml"
    assert words in ran.out


def test_a_launch_file_as_path_is_read_with_its_package(rtron, folder):
    path = folder / "launch" / "app.launch"
    ran = rtron("scan", path, "speed:=1", "--env", "KIND=base", "-j", "1")
    assert (ran.code, ran.err) == (1, "")
    assert "/cmd_vel" in ran.out
    assert f"rtron plan {folder} speed:=1 --launch {path} --env KIND=base" in ran.out
    planned = rtron("plan", path, "speed:=1", "--env", "KIND=base", "-j", "1", "-o", "-")
    assert (planned.code, "topic: /cmd_vel" in planned.out) == (0, True)
    both = graph(rtron, folder.parent, path, "speed:=1", "--env", "KIND=base", "-j", "1")
    assert both == graph(rtron, folder, *APP, "speed:=1")


def test_a_launch_file_in_no_package_is_read_with_its_folder(rtron, folder, tmp_path):
    path = tmp_path / "my robot.launch"
    path.write_text(PLAIN)
    (base,) = graph(rtron, path, "-j", "1")["endpoints"]
    assert (base["topic"], base["evidence"][0]["file"]) == (
        "/cmd_vel",
        str(folder / "scripts" / "base.py"),
    )


def test_a_launch_file_beside_another_app_is_an_error(rtron, folder, graph_file):
    path = folder / "launch" / "plain.launch"
    assert f"what is {path}?" in rtron("scan", graph_file, path).err
    assert f"both {path} and --live are given" in rtron("scan", path, "--live").err


def test_a_node_whose_source_has_an_error_is_no_success(rtron, folder):
    (folder / "scripts" / "base.py").write_text(BASE.replace('"cmd_vel"', '"cmd_vel'))
    app = ("scan", folder, "--launch", "robot/plain.launch", "-j", "1")
    ran = rtron(*app)
    assert ran.code == 1
    said = " ".join(ran.out.split())
    assert "0 of 1 nodes read; not read: /base; nothing can be found in them: correct " in said
    assert "Errors in the source (1) -> correct these places, and scan again base.py: " in said
    assert "(scripts/base.py:4)" in said
    assert rtron(*app, "--format", "json").code == 1
    assert rtron(*app, "--fail-on", "never").code == 0


def test_an_error_in_cpp_that_hides_the_program_is_listed(rtron, folder):
    (folder / "CMakeLists.txt").write_text("project(robot)\nadd_executable(base.py base.cpp)\n")
    broken = "#include <ros/ros.h>\nint main(int argc, char** argv {\n  ros::NodeHandle n; }\n"
    (folder / "base.cpp").write_text(broken)
    ran = rtron("scan", folder, "--launch", "robot/plain.launch", "-j", "1")
    assert ran.code == 1
    assert "base.cpp: cannot be read: 'int main(int argc, char** argv" in " ".join(ran.out.split())


def graph(rtron, *arguments):
    ran = rtron("scan", *arguments, "--format", "graph", "--fail-on", "never")
    assert (ran.code, ran.err) == (0, "")
    return json.loads(ran.out)


def test_arguments_are_for_all_launches_or_for_one(rtron, folder):
    assert {t["name"] for t in graph(rtron, folder, *APP, "speed:=1", "topic:=go")["topics"]} == {
        "/cmd_vel",
        "/go",
    }
    one = ("--launch", "robot/app.launch speed:=1 topic:=own", "--env", "KIND=base")
    topics = graph(rtron, folder, *one, "--launch", "robot/plain.launch", "topic:=all")["topics"]
    assert {topic["name"] for topic in topics} == {"/cmd_vel", "/own"}


def test_the_environment_is_the_given_one(rtron, folder, monkeypatch):
    monkeypatch.setenv("KIND", "drive")
    found = graph(rtron, folder, "--launch", "robot/app.launch", "speed:=1")
    assert any("KIND is not set" in note["why"] for note in found["unresolved"])
    found = graph(rtron, folder, *APP, "speed:=1")
    assert {"name": "/kind", "executable": "base.py"}.items() <= found["nodes"][3].items()


def test_a_scan_without_cache_leaves_nothing(rtron, folder, tmp_path):
    launch = ("--launch", folder / "launch/plain.launch")
    without = graph(rtron, folder, *launch, "--no-cache")
    assert not (tmp_path / "cache").exists()
    assert graph(rtron, folder, *launch) == without
    assert list((tmp_path / "cache/rtron/scan").iterdir())


@pytest.mark.parametrize(
    ("format", "start"),
    [("sarif", '{\n  "$schema"'), ("html", "<!doctype html>"), ("dot", "digraph")],
)
def test_other_formats(rtron, folder, tmp_path, format, start):
    out = tmp_path / "out"
    assert rtron("scan", folder, *APP, "speed:=1", "--format", format, "-o", out).code == 1
    assert out.read_text().lower().startswith(start)


def test_sarif_places_are_relative_to_the_folder(rtron, folder):
    text = rtron("scan", folder, *APP, "speed:=1", "--format", "sarif").out
    assert '"uri": "scripts/drive.py"' in text


def test_a_plan_of_an_app_in_source(rtron, folder, tmp_path):
    ran = rtron("plan", folder, *APP, "speed:=1", "-o", tmp_path / "rtron.yaml")
    assert ran.code == 0
    launch = folder / "launch/app.launch"
    options = f"speed:=1 --env KIND=base --plan {tmp_path / 'rtron.yaml'}"
    assert f"rtron instrument {launch} {options} -o guarded.launch\n" in ran.out
    assert "/cmd_vel" in (tmp_path / "rtron.yaml").read_text()


def test_the_next_step_names_the_launch_file_as_seen_from_here(rtron, folder, monkeypatch):
    monkeypatch.chdir(folder)
    ran = rtron("plan", folder, *APP, "speed:=1", "-o", "rtron.yaml")
    assert "rtron instrument launch/app.launch speed:=1 --env KIND=base --plan rtron" in ran.out


def test_the_next_steps_guard_several_launch_files_by_one(rtron, folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (folder / "launch/one.launch").write_text(ONE)
    launches = ("--launch", 'robot/one.launch name:="it\'s"', "--launch", "robot/plain.launch")
    ran = rtron("plan", folder, *launches, "-j", "1", "-o", "rtron.yaml")
    write, instrument = ran.out.partition("\nNext\n")[2].splitlines()
    subprocess.run(["/bin/sh", "-c", write], check=True)
    assert rtron(*shlex.split(instrument)[1:]).code == 0
    guarded = [path.read_text() for path in sorted((tmp_path / "guarded.d").glob("*.launch"))]
    assert [text.count("<remap") for text in guarded] == [1, 1]
    assert "rtron_guard" in (tmp_path / "guarded.launch").read_text()


BRANCHES = """<launch><arg name="mission" default="patrol"/>
<node pkg="robot" type="$(optenv KIND base).py" name="kind"/>
<node pkg="elsewhere" type="arm" name="arm"/>
<include file="$(find absent)/launch/arm.launch"/>
<node pkg="robot" type="drive.py" name="a"/><node pkg="robot" type="drive.py" name="b"/>
<node pkg="robot" type="base.py" name="base"/>
</launch>"""


@pytest.fixture
def branches(folder):
    (folder / "launch" / "branches.launch").write_text(BRANCHES)
    return ("--launch", "robot/branches.launch", "-j", "1", "--fail-on", "never")


def scanned_executable(rtron, folder, *words):
    document = json.loads(rtron("scan", folder, *words, "--format", "graph").out)
    return next(node["executable"] for node in document["nodes"] if node["name"] == "/kind")


def test_the_users_own_environment_counts_where_it_is_asked_for(
    rtron, folder, branches, monkeypatch
):
    monkeypatch.setenv("KIND", "drive")
    assert scanned_executable(rtron, folder, *branches) == "base.py"
    for words in (("--env", "KIND"), ("--env-all",), ("--env", "KIND=drive")):
        assert scanned_executable(rtron, folder, *branches, *words) == "drive.py"
    assert "--env-all -o rtron.yaml" in rtron("plan", folder, *branches[:2], "--env-all").out


def head(ran):
    return " ".join(ran.out.split("\n\n")[0].split())


def test_the_head_says_what_is_missing_and_how_to_give_it(rtron, folder, branches):
    said = head(rtron("scan", folder, *branches, "misson:=parking"))
    assert "not here: packages absent, elsewhere; give the folders of their source too" in said
    assert "not given: environment variable KIND; --env KIND takes your own value" in said
    assert "launch argument misson: no launch file declares it: did you mean mission?" in said
    said = head(rtron("scan", folder, *branches, "--env", "KIND=base", "mission:=parking"))
    assert "not given" not in said
    assert "no launch file declares" not in said


def test_an_argument_under_a_condition_is_declared(rtron, folder, branches):
    skipped = '<arg name="robot" default="a" if="false"/><group if="0"><arg name="b"/></group>'
    (folder / "launch" / "branches.launch").write_text(BRANCHES.replace("\n", skipped, 1))
    said = head(rtron("scan", folder, *branches, "robot:=x", "b:=x"))
    assert "no launch file declares" not in said


def test_an_argument_that_a_file_uses_without_declaring_it_is_known(rtron, folder, branches):
    used = '<param name="a" value="$(arg robot)"/><param name="b" value="$(eval arg(\'b\'))"/>\n'
    (folder / "launch" / "branches.launch").write_text(BRANCHES.replace("\n", used, 1))
    said = head(rtron("scan", folder, *branches, "robot:=x", "b:=x", "other:=x"))
    assert said.count("no launch file declares") == 1
    assert "launch argument other: no launch file declares it" in said


def test_the_distribution_is_guessed_from_the_workspace(rtron, folder, branches, monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "kinetic")
    assert "ROS_DISTRO" not in head(rtron("scan", folder, *branches))
    (folder / ".travis.yml").write_text("env: ROS_DISTRO=melodic\n")
    said = head(rtron("scan", folder, *branches))
    assert "ROS_DISTRO=melodic is a guess, from robot/.travis.yml" in said
    assert "a guess" not in head(rtron("scan", folder, *branches, "--env", "ROS_DISTRO"))
    said = head(rtron("plan", folder, *branches[:2]))
    assert "ROS_DISTRO=melodic is a guess, from robot/.travis.yml" in said
    said = head(rtron("plan", folder, *branches[:2], "--env", "ROS_DISTRO"))
    assert "a guess" not in said


@pytest.mark.parametrize(
    ("arguments", "said", "help"),
    [
        (["--launch", "robot/ap.launch"], "no launch file robot/ap.launch", "robot/app.launch"),
        (
            ["--launch", "robot/app.launch", "--env", "KIND=x"],
            "needs a value for speed",
            "speed:=…",
        ),
        (["--launch", ""], "no launch file", ""),
        (["--launch", "robot/broken.launch"], "broken.launch", ""),
        (["--launch", "robot/plain.launch 'x"], "quotation", "quote"),
        (["--launch", "robot/plain.launch", "--env", "X"], "X is not set here", "--env X=VALUE"),
        (["--launch", "robot/plain.launch", "--env", "=1"], "--env =1", "NAME=VALUE"),
        (["--launch", "robot/plain.launch", ":=1"], ":=1", "NAME:=VALUE"),
        (["--format", "html"], "--launch is missing", "text or json"),
        (["graph.json", "--launch", "robot/plain.launch"], "graph.json is not a folder", ""),
        (["--live"], "--live", "leave one"),
    ],
)
def test_bad_arguments_are_2_and_say_what_to_do(rtron, folder, arguments, said, help):
    ran = rtron("scan", folder, *arguments)
    assert (ran.code, ran.out) == (2, "")
    assert said in ran.err
    assert not help or "\nhelp: " in ran.err
    assert help in ran.err


def test_a_folder_without_launch_files_is_2(rtron, folder):
    ran = rtron("scan", folder / "scripts")
    assert (ran.code, ran.out) == (2, "")
    assert "no launch files" in ran.err


def test_launch_names_are_completed(folder, monkeypatch):
    context = SimpleNamespace(params={"inputs": [str(folder)]}, args=[])
    assert complete_launch(context, "robot/p") == ["robot/plain.launch"]
    monkeypatch.chdir(folder)
    assert len(complete_launch(SimpleNamespace(params={}, args=[]), "")) == 3
    gone = SimpleNamespace(params={"inputs": ["/nowhere"]}, args=[])
    assert complete_launch(gone, "") == []


SCRIPT = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
prefix = rospy.get_param("~prefix")
rospy.Publisher(prefix + "/out", String, queue_size=1, latch=True)
rospy.Publisher(rospy.get_param("~out", "out"), String)
rospy.Subscriber("~in", String, None)
rospy.Subscriber("/all", String, None)
rospy.Publisher(input(), String)
"""


def test_drafting_leaves_the_recursion_limit_as_it_was(rtron, folder):
    (folder / "scripts/talk.py").write_text(SCRIPT)
    before = sys.getrecursionlimit()
    assert rtron("model", "draft", folder / "scripts/talk.py").code == 0
    assert sys.getrecursionlimit() == before


def test_a_drafted_model_is_a_model(rtron, folder, tmp_path):
    (folder / "scripts/talk.py").write_text(SCRIPT)
    ran = rtron("model", "draft", folder / "scripts/talk.py", "-o", tmp_path / "talk.yaml")
    assert (ran.code, ran.out) == (0, "")
    model = read_model(tmp_path / "talk.yaml", Model)
    assert model.node == ("robot/talk.py",)
    parameters = ParameterTree()
    parameters.set("/x/talk/prefix", Parameter(value="mine", evidence=Evidence(file="")))
    found = node_interface(model, NodeSite(name="/x/talk", parameters=parameters))
    assert {(str(d.kind), d.name) for d in found.declarations} == {
        ("publish", "/x/mine/out"),
        ("publish", "/x/out"),
        ("subscribe", "/x/talk/in"),
        ("subscribe", "/all"),
    }
    assert next(d for d in found.declarations if d.name == "/x/mine/out").latched
    assert len(found.unresolved) == 1
    assert "a parameter's default" in (tmp_path / "talk.yaml").read_text()


def test_what_is_no_program_has_no_model(rtron, folder):
    for path in (folder / "package.xml", folder, folder / "none.py"):
        ran = rtron("model", "draft", path)
        assert (ran.code, ran.out) == (2, "")
        assert "is no program's source" in ran.err


def test_a_deep_folder_in_a_package_ends_nothing(rtron, folder, deep_folder):
    deep_folder(folder / "scripts")
    ran = rtron("scan", folder)
    assert (ran.code, ran.err) == (0, "")
    assert "cannot be read" in ran.out
    found = rtron("scan", folder, *APP, "speed:=1", "--format", "graph", "--fail-on", "never")
    assert (found.code, found.err) == (0, "")
    nodes = {node["name"] for node in json.loads(found.out)["nodes"]}
    assert nodes == {"/a", "/b", "/base", "/kind"}


def test_files_with_names_that_no_file_can_have_are_unresolved(rtron, folder):
    long = "n" * 5000
    path = f"$(find robot)/{long}"
    text = f'<launch><include file="{path}"/><rosparam file="{path}"/></launch>'
    (folder / "launch/long.launch").write_text(text)
    ran = rtron("scan", folder, "--launch", "robot/long.launch", "--fail-on", "never")
    assert (ran.code, ran.err) == (0, "")
    assert "File name too long" in ran.out


@pytest.mark.parametrize(
    "words",
    [
        ("scan", "PATH"),
        ("scan", "PATH", "--launch", "a/b"),
        ("scan", "PATH", "."),
        ("plan", "PATH"),
        ("replay", "PATH", "--plan", "x"),
        ("survey", "PATH"),
        ("classify", "PATH"),
        ("explain-function", "PATH"),
        ("explain-function", "x", "--from", "PATH"),
        ("functions", "graph", "PATH"),
        ("functions", "apps", "PATH"),
    ],
)
def test_a_path_that_no_file_can_have_is_2(rtron, words):
    ran = rtron(*(word.replace("PATH", "n" * 5000) for word in words))
    assert (ran.code, ran.out) == (2, "")
    assert "nnn: File name too long" in ran.err
