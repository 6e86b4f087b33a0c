import json

from rtron.planning.problem import PlanProblem
from rtron.reports.plan.instrumentation import (
    InstrumentedLaunch,
    NodeRemap,
    UnenforceableNode,
    instrumentation_text,
    instrumentation_to_json,
)
from rtron.reports.plan.problems import problems_text


def remap(node, written, target):
    return NodeRemap(node=node, topic="/cmd_vel", written=written, target=target)


GUARDED = InstrumentedLaunch(
    launch="/tmp/my app/guarded.launch",
    files=("/tmp/my app/guarded.launch",),
    remaps=(
        remap("/teleop", "cmd_vel", "/rtron/cmd_vel/flow2"),
        remap("/base", "/cmd_vel", "/rtron/cmd_vel/out"),
        remap("/teleop", "stop", "/rtron/stop/flow1"),
    ),
    unenforceable=(
        UnenforceableNode(what="/arm", why="this launch does not start it", accepted=False),
        UnenforceableNode(what="/legs", why="the developer knows", accepted=True),
    ),
    notes=("/rviz is not started by this launch",),
)

AT_80_COLUMNS = """\
/tmp/my app/guarded.launch  3 remaps on 2 nodes

/base
  /cmd_vel  to  /rtron/cmd_vel/out

/teleop
  cmd_vel  to  /rtron/cmd_vel/flow2
  stop     to  /rtron/stop/flow1

Unenforceable (1)
  /arm
    this launch does not start it

Accepted (1)
  /legs
    the developer knows

Notes
  /rviz is not started by this launch

Next
  close what is unenforceable, or name it in the plan's accept_unenforceable
  roslaunch '/tmp/my app/guarded.launch'
"""


def test_at_80_columns(printed):
    assert printed(instrumentation_text(GUARDED)) == AT_80_COLUMNS


def test_it_is_closed_when_all_that_is_open_is_accepted():
    assert not GUARDED.is_closed
    assert InstrumentedLaunch(
        launch="", files=(), remaps=(), unenforceable=GUARDED.unenforceable[1:], notes=()
    ).is_closed


def test_json_keys():
    document = json.loads(json.dumps(instrumentation_to_json(GUARDED)))
    assert list(document) == [
        "schema",
        "launch",
        "files",
        "remaps",
        "unenforceable",
        "notes",
        "ros",
        "guards_nothing",
        "left_out",
    ]
    assert document["remaps"][1] == {
        "node": "/base",
        "topic": "/cmd_vel",
        "written": "/cmd_vel",
        "target": "/rtron/cmd_vel/out",
    }
    assert document["unenforceable"][0]["accepted"] is False


def test_problems(printed):
    remarks = [
        PlanProblem("error", "grcn_x", "no such topic"),
        PlanProblem("warning", "/y", "unused"),
    ]
    assert printed(problems_text("rtron.yaml", remarks)) == (
        "rtron.yaml  2 problems\n"
        "  error    grcn_x\n           no such topic\n"
        "  warning  /y\n           unused\n"
    )
    assert printed(problems_text("rtron.yaml", [])) == "rtron.yaml  no problems\n"


def test_hostile_names_do_nothing(printed):
    name = "/\x1b[2J[bold]\n"
    guarded = InstrumentedLaunch(
        launch=name,
        files=(),
        remaps=(remap(name, name, name),),
        unenforceable=(UnenforceableNode(what=name, why=name, accepted=False),),
        notes=(name,),
    )
    text = printed(instrumentation_text(guarded)) + printed(
        problems_text(name, [PlanProblem(name, name, name)])
    )
    assert "\x1b" not in text
    assert text.count("/\\x1b[2J[bold]\\n") == 12
