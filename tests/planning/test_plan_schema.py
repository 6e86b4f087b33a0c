"""The JSON Schema tells the same form that the reader follows."""

import json
import re

from rtron.planning import plan_json_schema
from rtron.planning.form import NOUNS, keys
from rtron.vocabulary import Flow, Plan, PolicyName

SCHEMA = plan_json_schema()
FLOW = SCHEMA["$defs"]["Flow"]


def test_it_is_plain_json():
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA
    assert SCHEMA["title"] == "rtron.plan/1"


def test_it_describes_every_noun_and_key_and_no_other():
    assert set(SCHEMA["$defs"]) == {noun.__name__ for noun in NOUNS} - {"Plan"}
    for noun in NOUNS:
        described = SCHEMA if noun is Plan else SCHEMA["$defs"][noun.__name__]
        assert list(described["properties"]) == list(keys(noun))
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


def test_patterns_are_those_of_the_reader():
    pattern = FLOW["properties"]["publisher"]["pattern"]
    assert re.search(pattern, "/move_base")
    assert not re.search(pattern, "move_base")
    assert keys(Flow)["publisher"].text.fits("/move_base")


def test_every_reference_leads_somewhere():
    for name in re.findall(r'"#/\$defs/(\w+)"', json.dumps(SCHEMA)):
        assert name in SCHEMA["$defs"]
