import json

import pytest
from file_tree import write

LAUNCH = """\
<launch>
  <arg name="rate"/>
  <node pkg="teleop" type="keyboard" name="keyboard" args="$(arg rate)"/>
  <node pkg="nav" type="planner" name="planner"/>
  <node pkg="base" type="base" name="base"/>
</launch>
"""


@pytest.fixture
def launch_file(tmp_path):
    path = tmp_path / "app.launch"
    path.write_text(LAUNCH)
    return path


@pytest.fixture
def instrument(rtron, plan_file, launch_file, tmp_path):
    """Instrument the launch file for the plan and return what was said."""
    out = tmp_path / "guarded.launch"

    def run(*arguments):
        return rtron("instrument", launch_file, "--plan", plan_file, "-o", out, *arguments)

    return run


def test_remaps_are_shown_by_node(instrument, tmp_path):
    ran = instrument("rate:=9")
    assert (ran.code, ran.err) == (0, "")
    assert "/base\n  /cmd_vel  to  /rtron/cmd_vel/out\n" in ran.out
    assert "Unenforceable" not in ran.out
    assert ran.out.endswith(f"roslaunch {tmp_path}/guarded.launch\n")
    assert "rtron_guard" in (tmp_path / "guarded.launch").read_text()


def test_json(instrument, tmp_path):
    document = json.loads(instrument("rate:=9", "--format", "json").out)
    assert document["schema"] == "rtron.instrumented/1"
    assert document["launch"] == f"{tmp_path}/guarded.launch"
    assert document["launch"] in document["files"]
    assert document["unenforceable"] == []
    assert {
        "node": "/base",
        "topic": "/cmd_vel",
        "written": "/cmd_vel",
        "target": "/rtron/cmd_vel/out",
    } in document["remaps"]


def test_for_a_plan_that_guards_nothing_no_file_is_written(instrument, plan_file, tmp_path):
    plan_file.write_text(plan_file.read_text().replace("mode: enforce", "mode: observe"))
    ran = instrument("rate:=9")
    assert (ran.code, ran.err) == (1, "")
    assert ran.out.startswith("This plan guards nothing: ")
    why = "its coordination node only observes: `mode: enforce` guards it"
    assert ran.out.endswith(f"\n\nLeft out (1)\n  warning  /cmd_vel\n           {why}\n")
    assert not (tmp_path / "guarded.launch").exists()
    document = json.loads(instrument("rate:=9", "--format", "json").out)
    assert (document["launch"], document["files"], document["guards_nothing"]) == ("", [], True)
    (left_out,) = document["left_out"]
    assert left_out == {"level": "warning", "location": "/cmd_vel", "message": why}


def test_the_graph_tells_what_a_plan_that_guards_nothing_lacks(
    instrument, plan_file, graph_file, tmp_path
):
    plan_file.write_text("schema: rtron.plan/1\napp: small\nros: 1\n")
    ran = instrument("rate:=9", "--graph", graph_file)
    assert (ran.code, "  warning  base\n           /cmd_vel: no coord" in ran.out) == (1, True)


def test_what_cannot_be_enforced_is_1_until_it_is_accepted(instrument, launch_file, plan_file):
    launch_file.write_text(LAUNCH.replace('  <node pkg="base" type="base" name="base"/>\n', ""))
    ran = instrument("rate:=9")
    assert ran.code == 1
    assert "Unenforceable (1)\n  /base\n" in ran.out
    assert "accept_unenforceable" in ran.out
    plan_file.write_text(plan_file.read_text() + "accept_unenforceable: [/base]\n")
    ran = instrument("rate:=9")
    assert ran.code == 0
    assert "Accepted (1)\n  /base\n" in ran.out


def test_an_argument_that_is_missing_or_of_another_form_is_2(instrument, tmp_path):
    assert "rate:=" in instrument().err
    ran = instrument("rate=9")
    assert ran.code == 2
    assert "what is 'rate=9'?" in ran.err
    assert instrument(":=9").code == 2
    assert not (tmp_path / "guarded.launch").exists()


def test_packages_are_looked_for_where_they_are_said_to_be(instrument, launch_file, tmp_path):
    package = tmp_path / "ws" / "mine"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>mine</name></package>")
    (package / "app.launch").write_text(LAUNCH)
    launch_file.write_text(
        '<launch><include file="$(find mine)/app.launch">'
        '<arg name="rate" value="9"/></include></launch>'
    )
    assert instrument("--packages", tmp_path / "ws").code == 0
    assert instrument().code == 1


@pytest.mark.parametrize("launch", ["mine/start.launch", "ws/mine/launch/start.launch"])
def test_without_folders_the_package_of_the_launch_file_is_found(
    rtron, plan_file, tmp_path, monkeypatch, launch
):
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "ws" / "mine" / "launch"
    folder.mkdir(parents=True)
    (folder.parent / "package.xml").write_text("<package><name>mine</name></package>")
    (folder / "app.launch").write_text(LAUNCH)
    (folder / "start.launch").write_text(
        '<launch><include file="$(find mine)/launch/app.launch">'
        '<arg name="rate" value="9"/></include></launch>'
    )
    ran = rtron("instrument", launch, "--plan", plan_file, "-o", "guarded.launch")
    assert (ran.code, ran.err) == (0, "")
    assert "/base\n  /cmd_vel  to  /rtron/cmd_vel/out\n" in ran.out


def test_where_ros_finds_the_package_the_working_folder_is_not_searched(
    rtron, plan_file, tmp_path, monkeypatch
):
    for place, text in (("ros", LAUNCH), ("here/src", "<launch/>")):
        package = tmp_path / place / "mine"
        package.mkdir(parents=True)
        (package / "package.xml").write_text("<package><name>mine</name></package>")
        (package / "app.launch").write_text(text)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    monkeypatch.chdir(tmp_path / "here")
    words = ("rate:=9", "--plan", plan_file, "-o", "guarded.launch")
    assert rtron("instrument", "mine/app.launch", *words).code == 0


STARTER = """\
#!/usr/bin/env python
import os
import roslaunch
here = os.path.dirname(os.path.realpath(__file__))
roslaunch.parent.ROSLaunchParent("", [here.replace("core/nodes", "nav/nav.launch")]).start()
"""


def test_a_launch_file_that_a_node_starts_is_guarded_in_a_copy(instrument, launch_file, tmp_path):
    base, planner = LAUNCH.splitlines()[4], LAUNCH.splitlines()[3]
    write(
        tmp_path / "ws",
        {
            "core/package.xml": "<package><name>core</name></package>",
            "core/nodes/start": STARTER,
            "nav/package.xml": "<package><name>nav</name></package>",
            "nav/nav.launch": f"<launch>{planner}</launch>",
        },
    )
    (tmp_path / "ws/core/nodes/start").chmod(0o755)
    starter = '<node pkg="core" type="start" name="start"/>'
    launch_file.write_text(f"<launch>{starter}{base}</launch>")
    document = json.loads(instrument("--packages", tmp_path / "ws", "--format", "json").out)
    copy = tmp_path / "guarded.d" / "overlay" / "nav" / "nav.launch"
    assert str(copy) in document["files"]
    assert str(copy.parents[1] / "core" / "nodes" / "start") in document["files"]
    assert "/rtron/cmd_vel/" in copy.read_text()
    assert "/planner" in {remap["node"] for remap in document["remaps"]}
    assert "/planner" not in {end["what"] for end in document["unenforceable"]}


def test_cells_do_not_get_one_user(instrument, tmp_path):
    graph = tmp_path / "graph.json"
    graph.write_text('{"schema": "rtron.graph/1", "app": "base"}')
    cells = ("--cell", "/base", "--cell", "/arm", "--cell-user", "driver")
    ran = instrument("rate:=9", "--graph", graph, *cells)
    assert ran.code == 2
    assert "/base, /arm need a user each" in ran.err


def test_no_launch_and_no_plan_are_2(rtron, plan_file, launch_file, tmp_path):
    out = tmp_path / "out.launch"
    assert rtron("instrument", tmp_path / "none", "--plan", plan_file, "-o", out).code == 2
    assert rtron("instrument", launch_file, "--plan", tmp_path / "none", "-o", out).code == 2
    assert rtron("instrument", launch_file).code == 2


def test_the_guard_checks_its_plan_against_the_graph_at_each_start(
    instrument, rtron, graph_file, quiet_file, tmp_path
):
    ran = instrument("rate:=9", "--graph", graph_file)
    folder = tmp_path / "guarded.d"
    assert (ran.code, ran.err) == (0, "")
    assert ' --graph "${0%/*}/graph.json"' in (folder / "guard").read_text()
    assert rtron("check", folder / "rtron.yaml", "--graph", folder / "graph.json").code == 0
    refused = instrument("rate:=9", "--graph", quiet_file)
    assert refused.code == 2
    assert "error: the plan does not fit the app" in refused.err


def test_a_launch_file_by_its_package_and_an_argument_that_no_file_declares(
    rtron, launch_file, plan_file, tmp_path
):
    package = tmp_path / "ws" / "car"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>car</name></package>")
    text = launch_file.read_text()
    (package / "app.launch").write_text(
        text.replace("</launch>", '<arg name="x$(optenv SIDE)" default="1"/></launch>')
    )
    words = ("--packages", tmp_path / "ws", "--plan", plan_file, "-o", tmp_path / "out.launch")
    ran = rtron("instrument", "car/app.launch", "rate:=9", "rat:=1", *words)
    assert ran.code == 0
    said = " ".join(ran.out.split())
    assert "launch argument rat: no launch file declares it: did you mean rate?" in said
    assert "environment variable SIDE is not given" in said
    ran = rtron("instrument", "car/ap.launch", *words)
    assert ran.code == 2
    assert "did you mean car/app.launch" in ran.err
