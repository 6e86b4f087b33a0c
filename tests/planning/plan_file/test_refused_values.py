"""Values that nobody can mean: a plan with one is refused when it is read, with what to write."""

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan, write_plan
from rtron.planning.plan_file.defaults import app_name
from rtron.vocabulary import Plan

LONGEST_NAME = 200
APPS = [
    ("home", True),
    ("my app (2), v1.0", True),
    ("..hidden", True),
    ("robots/home.launch", True),
    ("ロボット", True),
    ("x" * LONGEST_NAME, True),
    ("x" * (LONGEST_NAME + 1), False),
    ("", False),
    ("  ", False),
    (".", False),
    ("..", False),
    ("a/../b", False),
    ("a/.", False),
    ("../../etc/app", False),
    ("/etc/app", False),
    ("a/", False),
    ("a//b", False),
    ("a\nERROR alarm: forged", False),
    ("a\r", False),
    ("a\x1b[31m", False),
    ("a\u2028b", False),
    ("a\u202eb", False),
]


@pytest.mark.parametrize(("name", "is_allowed"), APPS)
def test_the_name_of_an_app_is_no_path_and_one_line(name, is_allowed):
    text = write_plan(Plan(app=name)) if name else 'app: ""\n'
    if is_allowed:
        assert parse_plan(text).app == name
    else:
        with pytest.raises(PlanError, match="is not an app's name like my_robot: one line"):
            parse_plan(text)


@pytest.mark.parametrize(
    ("title", "name"),
    [
        ("home", "home"),
        ("late/launch/late.launch", "late/launch/late.launch"),
        ("/opt/../app\n2", "opt/app 2"),
        ("x" * 300, "x" * LONGEST_NAME),
        ("x" * (LONGEST_NAME - 1) + "/y", "x" * (LONGEST_NAME - 1)),
        ("..", ""),
    ],
)
def test_a_proposed_plan_has_an_app_whose_name_can_be_read(title, name):
    assert app_name(title) == name
    assert parse_plan(write_plan(Plan(app=name))).app == name


FLOW = """\
grcn:
  - topic: /cmd_vel
    mode: enforce
    policy: Block
    flows: [{{name: nav, publisher: /nav, silent_after: {}}}]
"""
EVENT = """\
msrcn:
  mode: enforce
  eflows: [{{name: low, topic: /low, publisher: /battery, {}}}]
"""
MONITOR = "fps_monitor: [{{node: /detector, topic: /people, silent_after: {}}}]\n"
DURATIONS = [
    (FLOW, "{}"),
    (EVENT, "present: {}"),
    (EVENT, "silent: {}"),
    (EVENT, "present: 1 s, max_age: {}"),
    (MONITOR, "{}"),
]


@pytest.mark.parametrize(("plan", "key"), DURATIONS)
@pytest.mark.parametrize(
    ("duration", "is_allowed"), [("10 ms", True), ("9.9 ms", False), ("1 ns", False), ("0", False)]
)
def test_what_is_shorter_than_the_pause_between_two_messages(plan, key, duration, is_allowed):
    text = plan.format(key.format(duration))
    if is_allowed:
        assert parse_plan(text)
    else:
        with pytest.raises(PlanError, match=f"'{duration}' is not between 0.01 s and "):
            parse_plan(text)


USES = """\
grcn:
  - topic: /cmd_vel
    type: geometry_msgs/Twist
    mode: enforce
    policy: Block
    flows: [{{name: nav, publisher: /nav}}]
    uses: {}
"""
LIMITED = """\
rsrcn:
  mode: enforce
  policy: Constrain
  max_vel_limit: 1 m/s
  vflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{{name: nav, publisher: /nav}}]
      uses: {}
"""


@pytest.mark.parametrize("plan", [USES, LIMITED])
def test_the_components_that_a_base_obeys_are_some(plan):
    assert parse_plan(plan.format("[linear.x]"))
    assert parse_plan(plan.replace("uses: {}", "").format())
    with pytest.raises(PlanError, match="uses is empty: the base would obey all components"):
        parse_plan(plan.format("[]"))
