"""The rules that RTron brings, and how rules are read."""

import re
from collections import Counter
from importlib.resources import files

import pytest
import yaml
from function_examples import failing_examples

from rtron.errors import InputError
from rtron.functions.patterns.parser import parse_pattern
from rtron.functions.rules.loader import load_rules, parse_rules, parse_word_lists
from rtron.functions.text import name_tokens
from rtron.vocabulary import FunctionType

WORD = re.compile(r"(?<![.*@\w])[a-z]\w*(?![*\w])")


def patterns(document):
    if "rules" not in document:
        return list(document.values())
    return [
        text for rule in document["rules"] for text in (*rule["patterns"], *rule.get("vetoes", ()))
    ]


RULE = """
type: Sensors
rules:
  - id: a-rule
    weight: 3
    patterns: [camera driver]
    vetoes: [fake]
    matches: [camera_driver]
    not: [fake_camera_driver]
"""


def test_every_example_of_every_rule_holds():
    assert list(failing_examples(load_rules())) == []


def test_every_function_type_has_rules():
    assert {rule.type for rule in load_rules()} == set(FunctionType)


def test_every_rule_has_its_own_name():
    assert [
        name for name, count in Counter(rule.id for rule in load_rules()).items() if count > 1
    ] == []


def test_a_rule_is_read():
    (rule,) = parse_rules(RULE, "x.yaml", {})
    assert (rule.id, rule.type, rule.weight) == ("a-rule", FunctionType.SENSORS, 3)
    assert len(rule.sources) == 3
    assert list(failing_examples([rule])) == []


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("[camera_driver]", "[motor]", "a-rule misses 'motor'"),
        (
            "[fake_camera_driver]",
            "[camera drivers of ours]",
            "a-rule takes 'camera drivers of ours'",
        ),
        ("vetoes: [fake]", "vetoes: []", "a-rule takes 'fake_camera_driver'"),
    ],
)
def test_an_example_that_does_not_hold_is_told(old, new, fault):
    assert list(failing_examples(parse_rules(RULE.replace(old, new), "x.yaml", {}))) == [fault]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("Sensors", "Sensor", "x.yaml: type"),
        ("weight: 3", "weight: 0", "rules.0.weight"),
        ("weight: 3", "weight: 10", "rules.0.weight"),
        ("a-rule", "A rule", "rules.0.id"),
        ("[camera driver]", "[]", "rules.0.patterns"),
        ("[camera driver]", "['(camera']", r"x.yaml: pattern '\(camera'"),
        ("[fake]", "['@none']", "no list @none"),
        ("matches: [camera_driver]", "", "rules.0.matches"),
        ("not:", "nots:", "rules.0"),
        ("type: Sensors", "type: [", "not YAML"),
    ],
)
def test_a_wrong_rule_is_told(old, new, message):
    with pytest.raises(InputError, match=message):
        parse_rules(RULE.replace(old, new), "x.yaml", {})


@pytest.mark.parametrize("text", ["", "[]", "a word", "[" * 5000])
def test_what_holds_no_rules_is_told(text):
    with pytest.raises(InputError, match=r"x.yaml: (holds no rules|not YAML)"):
        parse_rules(text, "x.yaml", {})


def test_a_list_may_use_one_above_it():
    lists = parse_word_lists("makers: a | b\nall: '@makers | c'\n", "x.yaml")
    assert parse_pattern("@all", lists) == lists["all"]
    with pytest.raises(InputError, match="no list @later"):
        parse_word_lists("all: '@later'\nlater: a\n", "x.yaml")


def test_the_data_is_yaml_to_the_slow_loader_too():
    for file in (files("rtron.functions.rules") / "data").iterdir():
        assert yaml.load(file.read_text("utf-8"), yaml.SafeLoader)


def test_every_word_of_a_pattern_is_one_that_texts_have():
    for file in (files("rtron.functions.rules") / "data").iterdir():
        for word in WORD.findall(" ".join(patterns(yaml.safe_load(file.read_text("utf-8"))))):
            assert name_tokens(word).words == (word,), file.name
