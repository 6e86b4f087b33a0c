"""`rtron instrument` with a plan for ROS 2."""

import json

import pytest

PLAN = """\
schema: rtron.plan/1
app: a
ros: {ros}
grcn:
  - id: grcn_cmd_vel
    topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Block
    flows:
      - {{name: teleop, publisher: /teleop, priority: 2}}
      - {{name: nav, publisher: /nav, priority: 1}}
    successors: [/base]
"""
XML = """\
<launch>
  <arg name="who" default="teleop"/>
  <node pkg="t" exec="t" name="$(var who)"/>
  <node pkg="n" exec="n" name="nav"/>
  <node pkg="b" exec="b" name="base"/>
</launch>
"""
ROS1 = '<launch><node pkg="t" type="t" name="teleop"/></launch>'
PYTHON = "raise SystemExit('this must never run')\n"


@pytest.fixture
def instrument(rtron, tmp_path):
    """Instrument a launch file of some text and name for a plan of ROS 1 or 2."""

    def run(name, text, *more, ros=2, out=None):
        (tmp_path / "rtron.yaml").write_text(PLAN.format(ros=ros))
        (tmp_path / name).write_text(text)
        given = ("--plan", tmp_path / "rtron.yaml", "-o", tmp_path / (out or f"out.{name}"))
        return rtron("instrument", tmp_path / name, *given, *more)

    return run


def test_xml(instrument, tmp_path):
    ran = instrument("app.launch.xml", XML)
    assert (ran.code, ran.err) == (0, "")
    assert "/base\n  /cmd_vel  to  /rtron/cmd_vel/out\n" in ran.out
    assert ran.out.endswith(f"ros2 launch {tmp_path}/out.app.launch.xml\n")


def test_arguments_are_taken(instrument):
    ran = instrument("app.launch.xml", XML, "who:=joy")
    assert ran.code == 0
    assert "\n/teleop\n" not in ran.out
    assert "/teleop is not started by this launch" in ran.out


def test_python_is_wrapped_and_never_run(instrument, tmp_path):
    ran = instrument("app.launch.py", PYTHON, "--format", "json")
    document = json.loads(ran.out)
    assert (ran.code, document["schema"], document["ros"]) == (0, "rtron.instrumented/1", 2)
    wrapper = (tmp_path / "out.app.launch.py").read_text()
    assert f"APP = '{tmp_path}/app.launch.py'" in wrapper
    compile(wrapper, "out", "exec")


@pytest.mark.parametrize(
    ("name", "text", "ros", "out"),
    [
        ("app.launch", ROS1, 2, "g.launch"),
        ("app.launch.xml", ROS1, 2, None),
        ("app.launch.xml", XML, 1, None),
        ("app.launch.py", PYTHON, 1, None),
        ("app.launch.yaml", "launch: []", 1, None),
        ("app.launch.xml", XML, 2, "g.launch.py"),
    ],
)
def test_the_wrong_ros_or_the_wrong_suffix_is_2(instrument, tmp_path, name, text, ros, out):
    ran = instrument(name, text, ros=ros, out=out)
    assert ran.code == 2
    assert "help: " in ran.err
    if out is None:
        assert f"is no launch file of ROS {ros}" in ran.err
        assert f"`ros: {ros}`" in ran.err
    assert not list(tmp_path.glob("*.d"))


def test_a_file_that_is_not_there(rtron, tmp_path):
    (tmp_path / "rtron.yaml").write_text(PLAN.format(ros=2))
    for suffix in ("py", "xml", "yaml"):
        missing, out = tmp_path / f"no.launch.{suffix}", tmp_path / f"g.launch.{suffix}"
        ran = rtron("instrument", missing, "--plan", tmp_path / "rtron.yaml", "-o", out)
        assert (ran.code, str(missing) in ran.err) == (2, True)


def test_an_argument_that_a_python_launch_file_declares_is_not_missed(instrument):
    assert "launch argument" not in instrument("app.launch.py", PYTHON, "robot:=b").out
    ran = instrument("app.launch.xml", XML, "wo:=joy")
    assert "launch argument wo: no launch file declares it: did you mean who?" in ran.out
