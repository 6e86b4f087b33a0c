"""Expressions over types that the plan does not define: installed ones, and a recording's."""

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan
from rtron.vocabulary import MessageDefinition

INDEX = "share/ament_index/resource_index/rosidl_interfaces/my_msgs"
WEAR, DIG = "bool worn\nfloat32[3] hours", "float64 depth\n---\nbool done\n---\nint8 percent"
TEXT = """\
ros: 2
msrcn:
  mode: enforce
  aflows:
    - topic: /dig
      type: my_msgs/action/Dig
      flows: [{name: a1, publisher: /digger}]
      successors: [/arm]
  eflows:
    - {name: bad, topic: /wear, publisher: /arm, type: my_msgs/msg/Wear, when: event.worn}
  rules:
    - {name: worn, when: bad, block: [/dig]}
    - name: deep
      action: action.depth > 1.0
      block: [/dig]
"""
OWN = """\
messages:
  - {type: my_msgs/msg/Wear, definition: "bool worn\\nfloat32[3] hours"}
  - {type: my_msgs/action/Dig, definition: "float64 depth\\n---\\nbool done\\n---\\nint8 percent"}
"""
BAD, DEEP = 10, 14


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Have the types of the plan installed."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    for kind, name, text in (("msg", "Wear", WEAR), ("action", "Dig", DIG)):
        file = tmp_path / "share/my_msgs" / kind / f"{name}.{kind}"
        file.parent.mkdir(parents=True)
        file.write_text(text)
    index = tmp_path / INDEX
    index.parent.mkdir(parents=True)
    index.write_text("msg/Wear.msg\naction/Dig.action\n")


def faults(text, recorded=None):
    """Return what is wrong with a plan."""
    try:
        parse_plan(text, recorded_definitions=recorded or {})
    except PlanError as error:
        return f"{error} | {error.help}"
    return ""


def test_installed_types_need_no_definition_in_the_plan(installed):
    assert parse_plan(TEXT).messages == ()


@pytest.mark.parametrize(
    ("right", "wrong", "line", "said"),
    [
        ("event.worn", "event.wrn", BAD, "did you mean worn?"),
        ("event.worn", "event.hours", BAD, "not a truth"),
        ("action.depth", "action.done", DEEP, "has no field 'done'"),
        ("> 1.0", "> 1", DEEP, "write numbers compared with a float"),
        ("action.depth > 1.0", "place(1.0, 2.0) == place(1.0, 2.0)", DEEP, ""),
    ],
)
def test_what_is_wrong_with_them_is_told_as_if_the_plan_defined_them(
    installed, right, wrong, line, said
):
    text = TEXT.replace(right, wrong)
    found = faults(text)
    assert found.startswith(f"rtron.yaml:{line}: ")
    assert said in found
    assert found == faults(text + OWN)


def test_a_type_that_is_not_there_is_told_with_what_helps():
    found = faults(TEXT)
    assert f"rtron.yaml:{BAD}: when: RTron does not know the type my_msgs/msg/Wear" in found
    assert f"rtron.yaml:{DEEP - 1}: " not in found
    assert "action: RTron does not know the type my_msgs/action/Dig" in found
    assert "source the workspace that has it, or add its text under `messages`" in found
    assert "rosmsg" not in found


def test_an_installed_type_that_cannot_be_used_is_told_where_it_is_asked_for(installed, tmp_path):
    (tmp_path / "share/my_msgs/msg/Wear.msg").write_text("wstring worn")
    found = faults(TEXT)
    assert found.startswith(f"rtron.yaml:{BAD}: when: my_msgs/msg/Wear as it is installed here: ")


def test_a_recording_defines_what_nobody_else_does():
    text = TEXT[: TEXT.index("    - name: deep")]
    recorded = {"my_msgs/msg/Wear": WEAR, "my_msgs/msg/Tear": WEAR}
    plan = parse_plan(text, recorded_definitions=recorded)
    assert plan.messages == (MessageDefinition(type="my_msgs/Wear", definition=WEAR),)
    assert "did you mean worn?" in faults(text.replace("event.worn", "event.wrn"), recorded)


def test_the_plan_and_what_is_installed_count_before_a_recording(installed):
    recorded = {"my_msgs/msg/Wear": "int8 other", "my_msgs/action/Dig": DIG}
    assert parse_plan(TEXT, recorded_definitions=recorded).messages == ()
    assert len(parse_plan(TEXT + OWN, recorded_definitions=recorded).messages) == 2


@pytest.mark.parametrize("text", ["wstring worn", "bool", "Nobody knows", "my_msgs/Wear x"])
def test_a_recording_s_text_that_is_no_definition_is_none(text):
    assert "does not know the type my_msgs/msg/Wear" in faults(TEXT, {"my_msgs/msg/Wear": text})


def test_ros_1_takes_nothing_from_a_recording():
    text = TEXT[: TEXT.index("    - name: deep")].replace("ros: 2\n", "").replace("action/", "")
    assert "as `rosmsg show -r" in faults(text, {"my_msgs/Wear": WEAR})
