"""The JSON Schema tells the same form that the reader follows."""

import json
import re

import pytest
import yaml
from app_graphs import AUTORACE, HOME
from hypothesis import given
from jsonschema import Draft202012Validator
from test_write_plan import plans

from rtron.planning import plan_json_schema, propose_plan, write_plan
from rtron.planning.plan_file.fields import PLAN_TYPES, plan_fields
from rtron.risks import discover_risks
from rtron.vocabulary import Flow, Plan, PolicyName

SCHEMA = plan_json_schema()
FLOW = SCHEMA["$defs"]["Flow"]


def test_it_is_plain_json():
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert SCHEMA["title"] == "rtron.plan/1"


def test_it_describes_every_noun_and_key_and_no_other():
    assert set(SCHEMA["$defs"]) == {noun.__name__ for noun in PLAN_TYPES} - {"Plan"}
    for noun in PLAN_TYPES:
        described = SCHEMA if noun is Plan else SCHEMA["$defs"][noun.__name__]
        assert list(described["properties"]) == list(plan_fields(noun))
        assert described["additionalProperties"] is False
        assert described["description"]


def test_it_asks_for_what_the_reader_asks_for():
    assert SCHEMA["$defs"]["GRCN"]["required"] == ["topic", "mode", "policy", "flows"]
    assert FLOW["required"] == ["name", "publisher"]
    assert SCHEMA["required"] == []


def test_words_are_an_enumeration():
    policy = SCHEMA["$defs"]["GRCN"]["properties"]["policy"]
    assert policy == {"enum": [word.value for word in PolicyName]}
    assert SCHEMA["properties"]["schema"] == {"enum": ["rtron.plan/1"]}


def test_a_duration_is_a_number_or_has_a_unit():
    number, text = FLOW["properties"]["timeout"]["anyOf"][0]["anyOf"]
    assert number["type"] == "number"
    assert re.search(text["pattern"], "200 ms")
    assert not re.search(text["pattern"], "200 msec")


def test_a_duration_has_the_bounds_of_the_reader():
    number, _ = SCHEMA["$defs"]["StopProfile"]["properties"]["period"]["anyOf"]
    assert number == {"type": "number", "minimum": 0.001, "maximum": 1.0}


@pytest.mark.parametrize(
    ("noun", "key", "good", "wrong"),
    [
        ("RSRCN", "max_vel_limit", [0, 0.22, 1000, "0.22 m/s", "1e-3km/h"], [-1, 1001, "1 m", "x"]),
        ("RSRCN", "threshold", [0.02, "2 cm/frame"], [0, "2 cm/s"]),
        ("RSRCN", "max_turn_limit", [0, 1.5, "1.5 rad/s", "90 deg/s"], [-1, "1 m/s", "1 rad/s2"]),
        ("RSRCN", "max_side_limit", [0, 0.1, "10 cm/s"], [-1, "1 rad/s"]),
        ("RSRCN", "max_accel_limit", [0.01, "0.5 m/s2"], [0, "0.5 m/s"]),
        ("GRCN", "uses", [["linear.x", "angular.z"]], [[], "linear.x", ["x"], ["linear.w"]]),
        ("GuardedTopic", "uses", [["linear.y"]], [["angular"], ["linear.x.y"]]),
        ("StopProfile", "within", [0.05, 10, "800 ms"], [0.04, 11, "1 m"]),
        ("Supervision", "stall_after", [0.02, "55 ms", "0.2 s"], [0.01, 0.3, 0]),
        ("Supervision", "kill_after", ["500 ms", 10], [0.4, 11]),
        ("Supervision", "deliver_within", [0.2, "1 s", 5], [0.1, 6, 0]),
        ("Supervision", "audit_within", [5, "10 s", 60], [4, 61, 0]),
        ("Supervision", "start_within", [2, 120, "30 s"], [1, 121]),
        ("StopProfile", "decel", [1, "1 m/s2", "1 m/s^2"], [0, "1 m/s"]),
        ("Transform", "yaw", [-6.28, "90 deg", "1 rad"], [90, "90 °"]),
        ("Point", "x", [-5, "-5 m", "5 km"], [1e9, "5 s"]),
        ("Area", "name", ["kitchen", "trueish"], ["true", "in", "1", "a b"]),
        ("EventFlow", "name", ["low", "format"], ["for", "while"]),
        ("EventFlow", "on_silence", ["block", "set", "clear", "keep"], ["stop"]),
        ("EventFlow", "present", [0.1, "2 s", None], ["2 sec"]),
        ("MissionRule", "block", [["/goal", "aflow1"]], [["a b"], "/goal", ["/goal/"]]),
        ("MissionRule", "require", ["", "/alert", "low"], ["/a b"]),
        ("MissionRule", "frame", ["", "map", "/map", "a/b-c.d"], ["a b", "/"]),
        ("Area", "frame", ["map"], ["", "a b"]),
        ("MessageDefinition", "type", ["a/B", "a/msg/B"], ["", "B"]),
        ("MessageDefinition", "definition", ["int8 x\nint8 y\n"], ["x" * 65537, 1]),
        ("FpsMonitor", "camera", [None], ["/camera", {"name": "camera"}]),
        ("Plan", "stop", [{}, {"decel": 1}], [None, {"decl": 1}]),
    ],
)
def test_a_value_fits_as_it_does_for_the_reader(noun, key, good, wrong):
    described = SCHEMA if noun == "Plan" else SCHEMA["$defs"][noun]
    schema = {**described["properties"][key], "$defs": SCHEMA["$defs"]}
    validator = Draft202012Validator(schema)
    assert [value for value in good if not validator.is_valid(value)] == []
    assert [value for value in wrong if validator.is_valid(value)] == []


@pytest.mark.parametrize("graph", [HOME, AUTORACE])
def test_a_written_plan_fits_the_schema(graph):
    text = write_plan(propose_plan(graph, discover_risks(graph)))
    assert list(Draft202012Validator(SCHEMA).iter_errors(yaml.safe_load(text))) == []


@given(plans)
def test_every_written_plan_fits_the_schema(plan):
    written = yaml.safe_load(write_plan(plan))
    assert list(Draft202012Validator(SCHEMA).iter_errors(written)) == []


def test_patterns_are_those_of_the_reader():
    pattern = FLOW["properties"]["publisher"]["pattern"]
    assert re.search(pattern, "/move_base")
    assert not re.search(pattern, "move_base")
    assert plan_fields(Flow)["publisher"].text.matches("/move_base")


def test_every_reference_leads_somewhere():
    for name in re.findall(r'"#/\$defs/(\w+)"', json.dumps(SCHEMA)):
        assert name in SCHEMA["$defs"]
