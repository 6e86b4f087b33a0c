"""`rtron remaps`: the remaps of a plan, without a launch file."""

import json

import pytest

LAUNCH = """<launch>
  <node pkg="teleop" type="keyboard" name="keyboard"/>
  <node pkg="nav" type="planner" name="planner"/>
  <node pkg="base" type="base" name="base"/>
</launch>
"""
PLAN = """\
ros: {ros}
grcn:
  - topic: /cmd_vel
    mode: {mode}
    policy: Block
    flows: [{{name: nav, publisher: /nav}}, {{name: hand, publisher: '/teleop_*'}}]
    successors: [/base]
"""


@pytest.fixture
def written(tmp_path):
    """Write a plan and return its path."""

    def write(ros=1, mode="enforce"):
        path = tmp_path / "small.yaml"
        path.write_text(PLAN.format(ros=ros, mode=mode))
        return path

    return write


def listed(rtron, *words):
    ran = rtron("remaps", *words, "--format", "json")
    assert (ran.code, ran.err) == (0, "")
    found = json.loads(ran.out)
    assert found["schema"] == "rtron.remaps/1"
    return {each["node"]: each["arguments"] for each in found["nodes"]}


def test_each_node_of_the_plan_gets_its_remaps(rtron, written):
    assert listed(rtron, "--plan", written()) == {
        "/nav": ["/cmd_vel:=/rtron/cmd_vel/nav"],
        "/teleop_*": ["/cmd_vel:=/rtron/cmd_vel/hand"],
        "/base": ["/cmd_vel:=/rtron/cmd_vel/out"],
    }


def test_nodes_of_ros_2_take_rules(rtron, written):
    found = listed(rtron, "/base", "--plan", written(ros=2))
    assert found == {"/base": ["--ros-args", "-r", "/cmd_vel:=/rtron/cmd_vel/out"]}


def test_one_node_and_one_that_a_pattern_means(rtron, written):
    assert listed(rtron, "/teleop_7", "--plan", written()) == {
        "/teleop_7": ["/cmd_vel:=/rtron/cmd_vel/hand"]
    }
    ran = rtron("remaps", "/navi", "--plan", written())
    assert ran.code == 2
    assert "the plan has no node /navi" in ran.err
    assert "did you mean /nav?" in ran.err


@pytest.mark.parametrize(("ros", "start"), [(1, "rosrun PACKAGE NODE"), (2, "--ros-args -r")])
def test_the_text_can_be_pasted(rtron, written, ros, start):
    ran = rtron("remaps", "--plan", written(ros))
    assert "3 remaps on 3 nodes" in ran.out
    assert "\n  /cmd_vel:=/rtron/cmd_vel/out\n" in ran.out
    assert start in ran.out


def test_a_plan_that_enforces_nothing_has_none(rtron, written):
    ran = rtron("remaps", "--plan", written(mode="observe"))
    assert ran.code == 1
    assert "0 remaps on 0 nodes" in ran.out
    assert rtron("remaps", "/nav", "--plan", written(mode="observe")).code == 2


def test_they_are_those_of_the_guarded_launch(rtron, plan_file, tmp_path):
    (tmp_path / "app.launch").write_text(LAUNCH)
    out = tmp_path / "guarded.launch"
    words = ("instrument", tmp_path / "app.launch", "--plan", plan_file, "-o", out)
    instrumented = json.loads(rtron(*words, "--format", "json").out)
    placed = {
        each["node"]: [f"{each['topic']}:={each['target']}"] for each in instrumented["remaps"]
    }
    assert placed
    assert listed(rtron, "--plan", plan_file) == placed
