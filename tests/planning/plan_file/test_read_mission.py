"""The mission in a plan file: eflows, rules, areas, transforms and message definitions."""

from importlib.util import find_spec
from pathlib import Path

import pytest

from rtron.errors import PlanError
from rtron.planning import check_plan, parse_plan, read_plan, write_plan
from rtron.vocabulary import (
    MSRCN,
    SECOND,
    Area,
    EventFlow,
    Flow,
    GuardedTopic,
    MessageDefinition,
    MissionRule,
    Mode,
    Plan,
    Point,
    PolicyName,
    Transform,
    WhenUnknown,
)

MISSION = """\
msrcn:
  mode: enforce
  aflows:
    - topic: /goal
      type: geometry_msgs/PoseStamped
      flows: [{name: a1, publisher: /search}, {name: a2, publisher: /user}]
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{name: a3, publisher: /move_base}]
    - {topic: /alert, flows: [{name: a4, publisher: /alarm}]}
  eflows:
    - name: low
      topic: /battery
      publisher: /base
      type: sensor_msgs/BatteryState
      when: "!(event.percentage >= 0.2)"
      max_age: 5 s
      on_silence: keep
      on_error: set
    - {name: person, topic: /people, publisher: /detector, present: 2 s}
    - {name: blind, topic: /scan, publisher: /lidar, silent: 500 ms, frame: base}
    - {name: bad, topic: /wear, publisher: /arm, type: my_msgs/Wear, when: event.worn}
  rules:
    - name: recharge
      when: low && !person
      block: [/goal, a3]
      require: /alert
      reason: Low batteries must be charged.
    - name: keep_out
      action: inside(action.pose.position, kitchen)
      frame: map
      block: [a1, a2]
    - {name: worn, when: bad || blind, block: [/cmd_vel]}
  areas:
    - name: kitchen
      frame: map
      polygon:
        - {x: 0, y: 0}
        - {x: 3 m, y: 0 cm}
        - {x: 3, y: -250 cm}
  transforms:
    - {source: odom, target: map, x: 1 m, yaw: 180 deg}
messages:
  - type: my_msgs/Wear
    definition: |
      bool worn
      float32 precision
"""
LOW = '"!(event.percentage >= 0.2)"'

UNKNOWN, END = (5, 19) if find_spec("cel_expr_python") else (1, 18)
"""Where a compiler points at `evnt.percentage` and behind `event.percentage <`: Google's, ours."""


def faults(text: str) -> list[str]:
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    return str(caught.value).splitlines()


def swap(old: str, new: str, text: str = MISSION) -> str:
    assert old in text
    return text.replace(old, new, 1)


def test_everything_about_a_mission():
    plan = parse_plan(MISSION)
    assert plan.messages == (
        MessageDefinition(type="my_msgs/Wear", definition="bool worn\nfloat32 precision\n"),
    )
    assert plan.msrcn == MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(
            GuardedTopic(
                topic="/goal",
                type="geometry_msgs/PoseStamped",
                flows=(Flow(name="a1", publisher="/search"), Flow(name="a2", publisher="/user")),
            ),
            GuardedTopic(
                topic="/cmd_vel",
                type="geometry_msgs/Twist",
                flows=(Flow(name="a3", publisher="/move_base"),),
            ),
            GuardedTopic(topic="/alert", type="", flows=(Flow(name="a4", publisher="/alarm"),)),
        ),
        eflows=(
            EventFlow(
                name="low",
                topic="/battery",
                publisher="/base",
                type="sensor_msgs/BatteryState",
                when="!(event.percentage >= 0.2)",
                max_age=5 * SECOND,
                on_silence=WhenUnknown.KEEP,
                on_error=WhenUnknown.SET,
            ),
            EventFlow(name="person", topic="/people", publisher="/detector", present=2 * SECOND),
            EventFlow(
                name="blind", topic="/scan", publisher="/lidar", silent=SECOND // 2, frame="base"
            ),
            EventFlow(
                name="bad", topic="/wear", publisher="/arm", type="my_msgs/Wear", when="event.worn"
            ),
        ),
        rules=(
            MissionRule(
                name="recharge",
                when="low && !person",
                block=("/goal", "a3"),
                require="/alert",
                reason="Low batteries must be charged.",
            ),
            MissionRule(
                name="keep_out",
                action="inside(action.pose.position, kitchen)",
                frame="map",
                block=("a1", "a2"),
            ),
            MissionRule(name="worn", when="bad || blind", block=("/cmd_vel",)),
        ),
        areas=(
            Area(
                name="kitchen",
                frame="map",
                polygon=(Point(x=0, y=0), Point(x=3, y=0), Point(x=3, y=-2.5)),
            ),
        ),
        transforms=(Transform(source="odom", target="map", x=1.0, yaw=3.141592653589793),),
    )


def test_it_is_written_to_be_read():
    plan = parse_plan(MISSION)
    text = write_plan(plan)
    assert parse_plan(text) == plan
    for line in (
        "    - {name: person, topic: /people, publisher: /detector, present: 2 s}",
        "      on_silence: keep",
        '      when: "low && !person"',
        '    - {name: worn, block: [/cmd_vel], when: "bad || blind"}',
        "        - {x: 3 m, y: -2.5 m}",
        "    - {source: odom, target: map, x: 1 m, yaw: 3.141592653589793 rad}",
        "    definition: |",
        "      float32 precision",
    ):
        assert f"\n{line}\n" in text
    assert max(map(len, text.splitlines()[1:])) <= 102  # the first line is an address


@pytest.mark.parametrize(
    ("old", "new", "line", "fault"),
    [
        # An eflow
        ("name: low", "name: while", 12, "'while' is not a word of letters, digits and _ that exp"),
        ("name: low", "name: in", 12, "name: 'in' is not a word"),
        ("name: low", "name: _low", 12, "name: '_low' is not a word"),
        ("name: low", "name: person", 20, "two flows have the name person"),
        ("name: low", "name: a1", 12, "two flows have the name a1"),
        ("name: low", "name: out", 12, "out is the guard's own"),
        ("/battery", "/goal", 13, "/goal is an aflow's: a topic that the MSRCN blocks is no event"),
        ("/battery", "/goal", 13, "use the rule's `action`"),
        ("present: 2 s", "present: 0", 20, "present: '0' is not between 0.01 s and"),
        ("present: 2 s", "present: 2 m", 20, "present: unknown unit 'm': did you mean"),
        ("present: 2 s", "present: 2 s, silent: 1 s", 20, "`present` or `silent`, not both"),
        (", present: 2 s", "", 20, "what sets the bit of this eflow? It needs `when`, `present`"),
        (", present: 2 s", ", when: ''", 20, "what sets the bit of this eflow?"),
        (", present: 2 s", ", when: ' '", 20, "when: ' ' is not an expression"),
        ("position, kitchen)", "position, kitchen)\n      action: ''", 31, "action stands twice"),
        ("inside(action.pose.position, kitchen)", "' '", 30, "action: ' ' is not an expression"),
        ("topic: /people", "topic: /wear, type: a/B", 22, "/wear is a my_msgs/Wear here and a a/B"),
        ("silent: 500 ms", "silent: 0 s", 21, "silent: '0 s' is not between 0.01 s and"),
        ("max_age: 5 s", "max_age: 0", 17, "max_age: '0' is not between 0.01 s and"),
        ("on_silence: keep", "on_silence: kep", 18, "unknown word 'kep': did you mean keep?"),
        ("on_error: set", "on_error: drop", 19, "unknown word 'drop': choose from"),
        ("frame: base", "frame: the base", 21, "frame: 'the base' is not a frame like map"),
        (LOW, "event.percent < 0.2", 16, "when: column "),
        (LOW, "event.percent < 0.2", 16, "has no field 'percent'"),
        (LOW, "event.percent < 0.2", 16, "did you mean percentage?"),
        (LOW, "event.percentage < 1", 16, "write numbers compared with a flo"),
        (LOW, "event.percentage", 16, "not a truth"),
        (LOW, "evnt.percentage < 0.2", 16, "did you mean event?"),
        (LOW, "event.percentage <", 16, "when: column "),
        (LOW, "x" * 4097, 16, "is not an expression of at most 4096 char"),
        (LOW, "1", 16, "when: '1' is no text: put it in quotes"),
        ("      type: sensor_msgs/BatteryState\n", "", 15, "the type is needed to check the"),
        (
            "type: sensor_msgs/BatteryState",
            "type: a/B",
            16,
            "RTron does not know the type a/B (add it",
        ),
        ("type: sensor_msgs/BatteryState", "type: a/B", 16, "as `rosmsg show -r a/B` prints it"),
        # A rule
        ("name: recharge", "name: worn", 33, "two rules have the name worn"),
        ("low && !person", "low && !persn", 25, "when: column 9 of the condition: there is no ef"),
        ("low && !person", "low && !persn", 25, "did you mean person?"),
        ("low && !person", "low and person", 25, "there is no eflow and"),
        ("low && !person", "low &&", 25, "it ends too early"),
        ("low && !person", "", 25, "when: "),
        ("low && !person", "low && !low", 25, "this can never hold"),
        ("low && !person", "'false'", 25, "this can never hold"),
        ("[/goal, a3]", "[]", 26, "a rule blocks at least one aflow or topic"),
        ("[/goal, a3]", "/goal", 26, "block is a list"),
        ("[/goal, a3]", "[/gaol]", 26, "no aflow or topic /gaol in the MSRCN: did you mean /goal?"),
        ("[/goal, a3]", "[a33]", 26, "no aflow or topic a33 in the MSRCN: did you mean a3?"),
        ("[/goal, a3]", "[low]", 26, "no aflow or topic low in the MSRCN"),
        ("[/goal, a3]", "[/go al]", 26, "block: '/go al' is not a full topic name like /cmd_vel"),
        ("require: /alert", "require: /alrt", 27, "no flow or topic /alrt in the MSRCN: did you"),
        ("require: /alert", "require: /goal", 27, "the rule itself blocks /goal, so it could nev"),
        ("require: /alert", "require: a1", 27, "the rule itself blocks a1"),
        ("require: /alert", "require: a3", 27, "the rule itself blocks a3"),
        ("require: /alert", "require: 3", 27, "require: '3' is no text"),
        ("require: /alert", "require: low", 27, "`when` names low: what makes the rule hold"),
        ("require: /alert", "require: person", 27, "`when` names person: what makes"),
        ("require: /alert", "require: /battery", 27, "`when` names low on /battery: what makes"),
        ("require: /alert", "require: /people", 27, "`when` names person on /people: what"),
        ("require: /alert", "require: blind", 27, "blind is the eflow of a silence, and a silenc"),
        ("require: /alert", "require: blind", 27, "does not speak: name its topic"),
        ("require: /alert", "require: blnd", 27, "no flow or topic blnd in the MSRCN: did you m"),
        ("require: /alert", "require: /scann", 27, "no flow or topic /scann in the MSRCN: did"),
        ("      block: [/goal, a3]\n", "", 24, "a rule needs block"),
        ("      reason", "      resaon", 28, "unknown key 'resaon' in a rule: did you mean"),
        ("[a1, a2]", "[a1, a3]", 30, "the blocked topics have different types (geometry_msgs/Pose"),
        ("[a1, a2]", "[a1, a4]", 30, "one that is not given"),
        ("[a1, a2]", "[a4]", 30, "the type of the blocked topic is needed: give the"),
        ("position, kitchen", "position, kitchn", 30, "nothing is called 'kitchn'"),
        ("position, kitchen", "position, kitchn", 30, "did you mean kitchen?"),
        ("inside(action.pose.position", "inside(action.pose", 30, "inside takes a Point and"),
        ("inside(action.pose", "inside(event.pose", 30, "nothing is called 'event'"),
        ("frame: map\n      block", "frame: odom\n      block", 30, "are in different frames"),
        ("geometry_msgs/PoseStamped", "geometry_msgs/Pose", 30, "geometry_msgs/Pose has no field"),
        ("geometry_msgs/PoseStamped", "a/Pose", 30, "action: RTron does not know the type a/Pose"),
        # An area, a transform
        ("name: kitchen", "name: a1", 35, "a1 is the name of a flow, too"),
        ("name: kitchen", "name: person", 35, "person is the name of a flow, too"),
        ("name: kitchen", "name: event", 35, "event means something else in expressions"),
        ("name: kitchen", "name: inside", 35, "inside means something else in expressions"),
        ("name: kitchen", "name: null", 35, "name: 'null' is no text: put it in quotes"),
        ("name: kitchen", "name: var", 35, "name: 'var' is not a word of letters"),
        ("      frame: map\n      polygon", "      polygon", 35, "an area needs frame"),
        ("        - {x: 0, y: 0}\n", "", 37, "an area has 3 to 100 corners"),
        ("{x: 0, y: 0}", "{x: 4, y: 0}", 0, ""),
        ("{x: 0, y: 0}", "{x: 3, y: 5}", 37, "the corners lie on one line"),
        ("{x: 0, y: 0}", "{x: 0}", 38, "a point needs y"),
        ("{x: 3 m, ", "{x: 3 s, ", 39, "x: unknown unit 's': choose from m, cm, mm, km"),
        ("{x: 3 m, ", "{x: .nan, ", 39, "x: '.nan' is no position"),
        ("{x: 3 m, y: 0 cm}", "[3, 0]", 39, "a point is a mapping with x, y"),
        ("target: map", "target: odom", 42, "a transform from odom to itself"),
        ("target: map", "target: /odom", 42, "a transform from odom to itself"),
        ("source: odom, ", "", 42, "a transform needs source"),
        ("source: odom", "source: ''", 42, "source: '' is not a frame like odom"),
        ("180 deg", "180", 42, "yaw: '180' is not between"),
        ("180 deg", "180 °", 42, "yaw: unknown unit '°'"),
        # A message definition
        ("type: my_msgs/Wear\n    def", "type: ''\n    def", 44, "type: '' is not a message type"),
        ("bool worn", "worn", 45, "line 1: neither a field nor a constant: 'worn'"),
        ("bool worn", "Other worn", 45, "my_msgs/Other of worn is not"),
        ("bool worn", "bool is_worn", 22, "has no field 'worn'"),
        ("    definition: |", "    definiton: |", 45, "did you mean definition?"),
        (
            "definition: |\n      bool worn\n      float32 precision",
            "definition: [a]",
            45,
            "is a single",
        ),
    ],
)
def test_a_slip_is_told_with_its_line(old, new, line, fault):
    if not line:
        assert parse_plan(swap(old, new))
        return
    with pytest.raises(PlanError) as caught:
        parse_plan(swap(old, new), "my.yaml")
    told = f"{caught.value} ({caught.value.help})".splitlines()
    assert any(text.startswith(f"my.yaml:{line}: ") and fault in text for text in told), told


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (LOW, "|\n        event.percentage < 0.2 ||\n        event.percentage > 2.0"),
        ("type: sensor_msgs/BatteryState", "type: sensor_msgs/msg/BatteryState"),
        ("require: /alert", "require: a4"),
        ("require: /alert", "require: bad"),
        ("require: /alert", "require: /wear"),
        ("require: /alert", "require: /scan"),
        ("require: /alert", "require: ''"),
        ("  mode: enforce\n", "  mode: enforce\n  policy: Block\n"),
        ("[a1, a2]", "[/goal]"),
        ("{source: odom, target: map, x: 1 m", "{source: odom, target: /base-1.x/y, x: 1 m"),
        ("low && !person", "(low || bad) && !person"),
        ("low && !person", '"true"'),
        (
            "silent: 500 ms",
            "silent: 500 ms, when: 'size(event.ranges) > 0', type: sensor_msgs/LaserScan",
        ),
    ],
)
def test_what_is_just_right(old, new):
    plan = parse_plan(swap(old, new))
    assert parse_plan(write_plan(plan)) == plan


@pytest.mark.parametrize(
    ("old", "new", "fault", "help"),
    [
        (LOW, "event.percent < 0.2", "when: column 6 of the", "did you mean percentage?"),
        (LOW, "evnt.percentage < 0.2", f"when: column {UNKNOWN} of the", "did you mean event?"),
        (LOW, "event.percentage < 1", "when: column 18 of the", "write numbers compared with a fl"),
        (LOW, "event.percentage", "when: the expression 'event.p", "compare it with something"),
        (LOW, "event.percentage <", f"when: column {END} of the", "see cel.dev for the language"),
        ("low && !person", "low && !persn", "when: column 9 of the", "did you mean person?"),
        ("low && !person", "low &&", "when: column 7 of the", "combine eflows with && || !"),
        ("position, kitchen", "position, kitchn", "action: column 30 of", "did you mean kitchen?"),
        (
            "type: sensor_msgs/BatteryState",
            "type: a/B",
            "when: RTron does not",
            "add it under `mes",
        ),
        (
            "      type: sensor_msgs/BatteryState\n",
            "",
            "the type is needed",
            "give the eflow's `ty",
        ),
        ("low && !person", "low && !low", "this can never hold", "`rtron schema plan` describes"),
        ("position, kitchen", "position, kitchen) && (3, 4", "action: column", "see cel.dev"),
    ],
)
def test_the_help_of_an_expression_is_its_own(old, new, fault, help):
    with pytest.raises(PlanError) as caught:
        parse_plan(swap(old, new), "my.yaml")
    _, _, told = str(caught.value).split(":", 2)
    assert told.startswith(f" {fault}")
    assert caught.value.help.startswith(help)
    assert caught.value.help not in told


def test_of_several_faults_each_has_its_own_help():
    text = swap("low && !person", "low && !persn", swap(LOW, "event.percent < 0.2"))
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    one, other = str(caught.value).splitlines()
    assert one.startswith("my.yaml:16: ")
    assert one.endswith("has no field 'percent' (did you mean percentage?)")
    assert other.startswith("my.yaml:25: ")
    assert other.endswith("there is no eflow persn (did you mean person?)")
    assert caught.value.help == "`rtron schema plan` describes every key"


def test_the_same_fault_on_one_line_twice_is_one_with_its_help():
    twice = "frame: map, when: low, block: [a1], action: action.x == 1}\n"
    text = swap("    - {name: worn", f"    - {{name: w0, {twice}    - {{name: worn")
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    assert len(str(caught.value).splitlines()) == 1
    assert caught.value.help.startswith("choose from header, pose")


EYES = "    - {name: eyes, topic: /people, publisher: /user, present: 2 s}\n"


@pytest.mark.parametrize("required", ["low", "blind", "person", "/people", "/battery"])
def test_what_is_required_may_not_be_what_the_rule_is_about(required):
    """`blind` and `eyes` are apart: each alone shows its own fault."""
    text = swap("  rules:\n", f"{EYES}  rules:\n")
    (told,) = faults(text.replace("require: /alert", f"require: {required}"))
    assert told.startswith("my.yaml:28: ")


@pytest.mark.parametrize("required", ["eyes", "bad", "/wear", "/scan", "a4", "/alert"])
def test_what_is_required_may_be_any_other_flow_or_topic(required):
    text = swap("  rules:\n", f"{EYES}  rules:\n")
    plan = parse_plan(text.replace("require: /alert", f"require: {required}"))
    assert plan.msrcn.rules[0].require == required


def test_a_silence_is_not_required_with_an_expression_either():
    silence = "silent: 500 ms, when: 'size(event.ranges) > 0', type: sensor_msgs/LaserScan"
    text = swap("silent: 500 ms", silence).replace("require: /alert", "require: blind")
    (told,) = faults(text)
    assert told.startswith("my.yaml:27: blind is the eflow of a silence")


def test_a_type_is_defined_once():
    again = "  - {type: my_msgs/msg/Wear, definition: bool worn}\n"
    assert faults(MISSION + again) == ["my.yaml:48: my_msgs/msg/Wear has two definitions"]


def test_two_areas_of_one_name_and_two_transforms_between_two_frames():
    area = (
        "    - {name: kitchen, frame: map, polygon: [{x: 0, y: 0}, {x: 1, y: 0}, {x: 0, y: 1}]}\n"
    )
    assert faults(swap("  transforms:\n", area + "  transforms:\n")) == [
        "my.yaml:41: two areas have the name kitchen"
    ]
    for ends in ("source: odom, target: map", "source: map, target: /odom"):
        text = swap("messages:\n", f"    - {{{ends}}}\nmessages:\n")
        (told,) = faults(text)
        assert told.startswith("my.yaml:43: two transforms between ")


def test_definitions_are_checked_without_a_mission_too():
    alone = MISSION[MISSION.index("messages:") :]
    assert parse_plan(alone).messages == parse_plan(MISSION).messages
    assert faults(alone.replace("bool worn", "bool"))[0].startswith("my.yaml:3: line 1: neither")


def test_a_topic_has_one_type_in_the_whole_plan():
    grcn = (
        "grcn:\n  - topic: /cmd_vel\n    mode: enforce\n    policy: Block\n"
        "    type: geometry_msgs/msg/Twist\n    flows: [{name: g1, publisher: /move_base}]\n"
    )
    assert parse_plan(MISSION + grcn)
    assert faults(MISSION + grcn.replace("Twist", "Pose"))[-1] == (
        "my.yaml:8: /cmd_vel is a geometry_msgs/Twist here and a geometry_msgs/msg/Pose elsewhere"
    )


def test_a_definition_may_name_a_type_that_another_one_defines():
    text = MISSION.replace("bool worn", "Other other\nbool worn".replace("\n", "\n      "))
    assert "Other of other is not defined" in faults(text)[0]
    assert parse_plan(text + "  - {type: my_msgs/Other, definition: int8 x}\n")


def test_a_definition_that_is_too_long():
    text = swap("bool worn", "bool worn # " + "x" * 65536)
    *_, told = faults(text)
    assert told.startswith("my.yaml:45: definition: 'bool worn # xxx")
    assert told.endswith("is not a text of at most 65536 characters")


def test_the_definition_of_the_plan_goes_before_the_standard_one():
    own = "  - {type: sensor_msgs/BatteryState, definition: float32 percent}\n"
    assert "has no field 'percentage'" in faults(MISSION + own)[0]


def test_a_plan_without_expressions_needs_no_messages():
    text = MISSION.split("  rules:", maxsplit=1)[0]
    text = "\n".join(line for line in text.splitlines() if "when" not in line)
    text = text.replace("max_age: 5 s", "present: 1 s")
    assert len(parse_plan(text).msrcn.eflows) == 3


def test_too_much_is_refused_soon():
    rules = "".join(f"    - {{name: r{i}, when: low, block: [a1]}}\n" for i in range(201))
    assert faults(swap("  areas:\n", rules + "  areas:\n"))[0].endswith("more than 200 rules")
    wanted = "".join(f"    - {{name: r{i}, block: [/x{i}]}}\n" for i in range(201))
    assert len(faults(swap("  areas:\n", wanted + "  areas:\n"))) <= 51
    corners = "polygon: [{x: 0, y: 0}, {x: 1, y: 0}, {x: 0, y: 1}]"
    areas = "".join(f"    - {{name: r{i}, frame: map, {corners}}}\n" for i in range(101))
    assert faults(swap("  transforms:\n", areas + "  transforms:\n")) == [
        "my.yaml:140: more than 100 areas"
    ]
    eflows = "".join(
        f"    - {{name: e{i}, topic: /x, publisher: /y, present: 1}}\n" for i in range(997)
    )
    assert faults(swap("  rules:\n", eflows + "  rules:\n")) == [
        "my.yaml:1019: more than 1000 eflows"
    ]
    event = "topic: /x, publisher: /y, type: std_msgs/Bool, when: event.data"
    eflows = "".join(f"    - {{name: e{i}, {event}}}\n" for i in range(201))
    told = faults(swap("  rules:\n", eflows + "  rules:\n"))
    assert told[0] == "my.yaml:221: more than 200 eflows with an expression"


def test_the_guard_refuses_what_check_refuses(tmp_path: Path):
    path = tmp_path / "rtron.yaml"
    path.write_text(swap("percentage", "percent"), encoding="utf-8")
    with pytest.raises(PlanError) as caught:
        read_plan(path)
    assert (caught.value.path, caught.value.line) == (str(path), 16)


def test_a_mission_without_doubts_has_no_problem():
    assert check_plan(parse_plan(MISSION)) == ()
    assert check_plan(Plan(app="")) == ()
