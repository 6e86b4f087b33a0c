"""A guarded launch as ROS's own loader reads it: the original, the guard, the plan's remaps."""

import pytest
from file_tree import write
from guarded_launch import assert_guarded, split_guard
from launch_cases import CASES, INCLUDES, Case
from plans import grcn, plan_of
from roslaunch_oracle import both

from rtron.planning.instrument import instrument_ros1, write_guarded_launch
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.sources.launch.ros1.reader import read_launch

pytestmark = pytest.mark.ros1

ROBOT = Case(
    "a robot",
    """
  <arg name="model" default="burger" doc="burger or waffle"/>
  <arg name="cmd" value="cmd_vel"/>
  <arg name="sensor" default="depth"/>
  <param name="use_sim_time" value="false"/>
  <param name="~inherited" value="by every node"/>
  <rosparam file="$(find one)/config.yaml" command="load" ns="config"/>
  <env name="ROBOT" value="$(arg model)"/>
  <remap from="scan" to="lidar"/>
  <node pkg="teleop" type="key" name="teleop" output="screen" respawn="true" respawn_delay="2"
        args="--speed 1"/>   <!-- a comment behind it -->
  <group ns="nav">
    <param name="here" value="$(dirname)/maps" />
    <node pkg="planner" type="planner" name="planner">
      <remap from="~cmd" to="/cmd_vel"/>
      <rosparam>literal: $(dirname)</rosparam>
      <rosparam subst_value="true">folder: $(dirname)</rosparam>
      <param name="speed" value="1.5"/>
      <env name="HERE" value="1"/>
    </node>
    <include file="$(find one)/launch/base.launch" ns="lower" pass_all_args="true">
      <arg name="topic" value="/$(arg cmd)"/>
    </include>
  </group>
  <include file="$(find one)/launch/$(arg sensor)__camera.launch" unless="0"/>
  <include file="$(find one)/launch/spawn.launch" ns="left"><arg name="n" value="1"/></include>
  <include file="$(find one)/launch/spawn.launch" ns="right"><arg name="n" value="2"/></include>
  <test pkg="tests" type="drive" test-name="drives" time-limit="5"
    ><remap from="c" to="cmd_vel"/></test>
  <node pkg="topic_tools" type="relay" name="$(anon relay)" args="cmd_vel other"/>
""",
    {
        "one/config.yaml": "a: {b: 1}\n",
        "one/launch/base.launch": """<?xml version="1.0"?>
<launch>
  <arg name="topic"/><arg name="model"/>
  <remap from="vel" to="$(arg topic)"/>
  <node pkg="base" type="$(arg model)" name="base" args="$(dirname)/firmware" required="true"/>
</launch>
""",
        "one/launch/depth__camera.launch": """<launch><group ns="camera">
\t<node pkg="nodelet" type="nodelet" name="manager" args="manager"/>
\t<node pkg="nodelet" type="nodelet" name="follow" args="load camera/Follow manager --no-bond">
\t\t<remap from="out" to="/cmd_vel"/></node>
</group></launch>
""",
        "one/launch/spawn.launch": """<launch>
  <arg name="n"/>
  <node pkg="spawn" type="spawn" name="robot_$(arg n)"><remap from="cmd_vel" to="/cmd_vel"/></node>
  <include file="$(dirname)/../launch/deep.launch"/>
</launch>""",
        "one/launch/deep.launch": """<launch>
<param name="deep" value="$(dirname) $( dirname )"/>
<param name="eval" value="$(eval dirname() + '/x')"/>
<node pkg="d" type="d" name="deep"/></launch>""",
    },
)
EVERYTHING = plan_of(
    grcn(
        "/cmd_vel",
        ["/teleop", "/nav/planner", "/camera/manager", "/left/robot_1", "/relay_*"],
        ["/nav/lower/base", "/left/robot_1", "/right/deep", "/drives"],
    ),
    grcn("/lidar", ["/left/deep"], ["/nav/planner"]),
    grcn("/b", ["/n", "/a", "/n_*", "/*/n"], ["/m", "/n", "/g/n"]),
)


def guard_and_load(ros, folder, case, plan):
    """Return ROS's reading of a case and of its guarded launch, and what guarding it gave."""
    original, ours = both(ros, folder, case)
    out = folder / "guarded" / "app.launch"
    guarded = instrument_ros1(
        read_launch(*ours), plan, out, GuardFiles("plan", command=("sleep", "1000"))
    )
    write_guarded_launch(guarded)
    _, args, _, environ = ours
    return original, ros.load(out, args, environ), guarded


@pytest.mark.parametrize("case", [ROBOT, *CASES, *INCLUDES], ids=lambda case: case.name)
def test_a_guarded_launch_is_the_original_but_for_the_plans_remaps(ros, tmp_path, case):
    original, guarded, _ = guard_and_load(ros, tmp_path, case, EVERYTHING)
    assert_guarded(original, guarded, EVERYTHING, ["/b", "/cmd_vel", "/lidar", "/n/a"])


def test_a_plan_that_enforces_nothing_adds_only_the_guard(ros, tmp_path):
    original, guarded, instrumented = guard_and_load(ros, tmp_path, ROBOT, plan_of())
    assert split_guard(guarded)[1]["nodes"] == original["nodes"]
    assert {path.name for path in instrumented.files} == {"app.launch", "guard", "rtron.yaml"}


def test_the_guarded_launch_takes_the_same_arguments(ros, tmp_path):
    guard_and_load(ros, tmp_path, ROBOT, EVERYTHING)
    environ = {"ROS_PACKAGE_PATH": str(tmp_path)}
    launches = (tmp_path / "app.launch", tmp_path / "guarded" / "app.launch")
    original, guarded = (ros.load(launch, {"model": "waffle"}, environ) for launch in launches)
    assert_guarded(original, guarded, EVERYTHING, ["/cmd_vel", "/lidar"])


def test_another_choice_of_a_changed_file_is_refused(ros, tmp_path):
    """Else the nodes of that file would be started without a guard before them."""
    guard_and_load(ros, tmp_path, ROBOT, EVERYTHING)
    environ = {"ROS_PACKAGE_PATH": str(tmp_path)}
    write(tmp_path, {"one/launch/none__camera.launch": "<launch/>"})
    guarded = ros.load(tmp_path / "guarded" / "app.launch", {"sensor": "none"}, environ)
    assert "none__camera.launch" in guarded["error"]


def test_a_changed_file_that_is_not_included_need_not_be_chosen(ros, tmp_path):
    include = '<include file="$(dirname)/$(env CAMERA).launch" if="$(arg camera)"/>'
    body = f'<arg name="camera" default="true"/>{include}'
    camera = {"cam.launch": '<launch><node pkg="p" type="t" name="n"/></launch>'}
    case = Case("", body, camera, environ={"CAMERA": "cam"})
    original, guarded, _ = guard_and_load(ros, tmp_path, case, EVERYTHING)
    assert_guarded(original, guarded, EVERYTHING, ["/b"])
    without = ros.load(tmp_path / "guarded" / "app.launch", {"camera": "false"})
    assert [node["full_name"] for node in without["nodes"]] == ["/rtron_guard"]


def test_the_guarded_launch_may_be_moved_with_its_folder(ros, tmp_path):
    original, _, _ = guard_and_load(ros, tmp_path, ROBOT, EVERYTHING)
    moved = (tmp_path / "guarded").rename(tmp_path / "else where")
    guarded = ros.load(moved / "app.launch", {}, {"ROS_PACKAGE_PATH": str(tmp_path)})
    assert_guarded(original, guarded, EVERYTHING, ["/cmd_vel", "/lidar"])
    assert split_guard(guarded)[0]["launch_prefix"] == f'"{moved}/app.d/guard"'


@pytest.mark.parametrize("surrounding", [{"ROS_NAMESPACE": "/robot"}, {}])
def test_the_guard_inherits_nothing(ros, tmp_path, surrounding):
    body = '<machine name="m" address="localhost" default="true"/><env name="E" value="1"/>'
    case = Case("", f'{body}<param name="~p" value="1"/><remap from="a" to="b"/>')
    _, guarded, _ = guard_and_load(ros, tmp_path, case, plan_of())
    guard, _ = split_guard(ros.load(tmp_path / "guarded" / "app.launch", {}, surrounding))
    assert (guard["namespace"], guard["machine_name"]) == ("/", None)
    assert guard["remap_args"] == guard["env_args"] == []
    assert (guard["respawn"], guard["output"]) == (True, "screen")
    assert not any("rtron" in name for name in guarded["params"])


def test_a_launch_file_in_another_encoding_is_guarded_too(ros, tmp_path):
    text = '<?xml version="1.0" encoding="ISO-8859-1"?>\n<launch><!-- señal -->\n'
    text += '<node pkg="p" type="t" name="n"><param name="x" value="¡sí!"/></node></launch>'
    path, out = tmp_path / "app.launch", tmp_path / "guarded.launch"
    path.write_bytes(text.encode("latin-1"))
    plan = plan_of(grcn("/a", ["/n"], []))
    write_guarded_launch(instrument_ros1(read_launch(path, {}, {}, {}), plan, out, GuardFiles("")))
    assert_guarded(ros.load(path), ros.load(out), plan, ["/a"])
    assert "<!-- señal -->" in out.read_text()
