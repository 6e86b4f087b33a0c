"""Values that nobody can mean: a plan with one is refused when it is read, with what to write."""

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan, write_plan
from rtron.planning.app_check import check_plan
from rtron.planning.plan_file.defaults import app_name
from rtron.vocabulary import MessageDefinition, Plan

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


VECTOR = f"{'=' * 80}\nMSG: geometry_msgs/Vector3\n"
XYZ, XZY = "float64 x\nfloat64 y\nfloat64 z\n", "float64 x\nfloat64 z\nfloat64 y\n"
LINEAR, ANGULAR = "geometry_msgs/Vector3 linear\n", "geometry_msgs/Vector3 angular\n"
TWIST = LINEAR + ANGULAR + VECTOR + XYZ
DEFINITIONS = [
    ("geometry_msgs/Twist", TWIST, True),
    ("geometry_msgs/msg/Twist", "# a comment\n" + TWIST, True),
    ("geometry_msgs/Twist", ANGULAR + LINEAR + VECTOR + XYZ, False),
    ("geometry_msgs/msg/Twist", ANGULAR + LINEAR + VECTOR + XYZ, False),
    ("geometry_msgs/Twist", LINEAR + ANGULAR + VECTOR + XZY, False),
    ("geometry_msgs/Twist", (TWIST).replace("64", "32"), False),
    (
        "geometry_msgs/TwistStamped",
        f"geometry_msgs/Twist twist\n{'=' * 80}\nMSG: geometry_msgs/Twist\n{TWIST}",
        False,
    ),
    ("std_msgs/Float64", "float64 data", True),
    ("std_msgs/Float64", "float32 data", False),
    ("ackermann_msgs/AckermannDrive", "float32 speed", False),
    ("my_msgs/Twist", ANGULAR + LINEAR + VECTOR + XYZ, True),
]


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize(("type", "text", "is_allowed"), DEFINITIONS)
def test_a_velocity_has_the_fields_that_it_has_in_ros(ros, type, text, is_allowed):
    defined = MessageDefinition(type=type, definition=text)
    plan = write_plan(Plan(app="a", ros=ros, messages=(defined,)))
    if is_allowed:
        assert parse_plan(plan).messages == (defined,)
    else:
        with pytest.raises(PlanError, match=f"{type} has other fields here than in ROS: no limit"):
            parse_plan(plan)


MISSION = """\
msrcn:
  mode: enforce
  eflows:
    - name: low
      topic: /battery
      publisher: /bms
      type: sensor_msgs/BatteryState
      when: {when}
      max_age: 5 s
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{{name: nav, publisher: /nav}}]
  rules: [{{name: battery, when: low, action: {action}, block: [/cmd_vel]}}]
"""
LOW_WARNING = "warning: MSRCN, eflow low: `when` holds for every message of /battery"
LOW, FAST = "event.percentage < 0.2", "action.linear.x > 0.5"
CONDITIONS = [
    (LOW, FAST, ""),
    ("false", FAST, "low is never 1"),
    ("event.percentage > 2.0 && event.percentage < 1.0", FAST, "low is never 1"),
    ("event.present && !event.present", FAST, "low is never 1"),
    ("event.voltage != event.voltage", FAST, "low is never 1"),
    (LOW, "false", "battery blocks nothing"),
    (LOW, "action.linear.x > 0.5 && action.linear.x < 0.5", "battery blocks nothing"),
    (LOW, "action.linear.x > 0.5 && action.linear.x < 0.6", ""),
]


@pytest.mark.parametrize(("when", "action", "fault"), CONDITIONS)
def test_an_expression_that_holds_for_no_message(when, action, fault):
    text = MISSION.format(when=f'"{when}"', action=f'"{action}"')
    if fault:
        with pytest.raises(PlanError, match=f"holds for no message: {fault}"):
            parse_plan(text)
    else:
        assert parse_plan(text)


@pytest.mark.parametrize(
    ("when", "help"),
    [
        ("event.voltage != event.voltage && event.present", "ask math.isNaN(event.voltage)"),
        ("event.voltage < event.voltage", "correct what it compares, or leave it out"),
    ],
)
def test_what_differs_from_itself_is_no_number(when, help):
    with pytest.raises(PlanError) as caught:
        parse_plan(MISSION.format(when=f'"{when}"', action=f'"{FAST}"'))
    assert caught.value.help == help


@pytest.mark.parametrize(
    ("when", "action", "warnings"),
    [
        (LOW, FAST, []),
        ("event.percentage >= -1.0", FAST, []),
        (
            "true",
            FAST,
            [f"{LOW_WARNING}: leave `when` out, and say with `present` how long a message counts"],
        ),
        (
            LOW,
            "action.linear.x < 1.0 || action.linear.x >= 1.0",
            ["warning: MSRCN, rule battery: `action` holds for every message: leave it out"],
        ),
    ],
)
def test_an_expression_that_holds_for_every_message_is_told(when, action, warnings):
    plan = parse_plan(MISSION.format(when=f'"{when}"', action=f'"{action}"'))
    assert [str(each) for each in check_plan(plan)] == warnings
