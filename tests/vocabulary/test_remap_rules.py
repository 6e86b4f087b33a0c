"""How ROS 2 expands names and which remap rules it applies; tests/ros2 asks a real rcl the same."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from remap_cases import CASES

from rtron.vocabulary.launch import Remap
from rtron.vocabulary.remap_rules import (
    UNKNOWN_NAME,
    expand_name,
    parse_remap_rules,
    remaps_for_node,
)


def resolved(rules, node, name):
    """Return a name under rules, of which the first that matches counts."""
    name = expand_name(name, node)
    found = [remap.target for remap in remaps_for_node(rules, node) if remap.source == name]
    return found[0] if found else name


@pytest.mark.parametrize(("rules", "node", "name", "target"), CASES)
def test_a_name_under_rules(rules, node, name, target):
    assert resolved(rules, node, name) == target


def test_a_rule_keeps_what_was_written():
    assert list(remaps_for_node([("driver:~/out", "there")], "/arm/driver")) == [
        Remap(
            written_source="driver:~/out",
            written_target="there",
            source="/arm/driver/out",
            target="/arm/there",
        )
    ]


def test_a_node_of_no_known_name_may_be_the_one_that_a_rule_is_for():
    [remap] = remaps_for_node([("driver:/out", "/there")], f"/arm/{UNKNOWN_NAME}")
    assert (remap.source, remap.target) == ("/out", "/there")


@pytest.mark.parametrize("rule", [("", "there"), ("out", "")])
def test_half_a_rule_is_none(rule):
    assert list(remaps_for_node([rule], "/driver")) == []


@pytest.mark.parametrize(
    ("arguments", "ros", "rules"),
    [
        ("", False, []),
        ("-r out:=there", True, [("out", "there")]),
        ("--remap out:=there", True, [("out", "there")]),
        ("-r out:=there", False, []),
        ("--ros-args -r out:=there", False, [("out", "there")]),
        ("--ros-args -r a:=b -- -r c:=d", False, [("a", "b")]),
        ("--ros-args -r a:=b -- x --ros-args -r c:=d", False, [("a", "b"), ("c", "d")]),
        ("-r a:=b -- -r c:=d", True, [("a", "b")]),
        ("-r driver:out:=there", True, [("driver:out", "there")]),
        ("-r rostopic://out:=there", True, [("rostopic://out", "there")]),
        ("-r __node:=other -r a:=b", True, [("a", "b")]),
        ("-r driver:__ns:=/other -r a:=b", True, [("a", "b")]),
        ("-p speed:=3 -r a:=b", True, [("a", "b")]),
        ("-r 'out:=there'", True, [("out", "there")]),
        ("-r", True, []),
        ("-r out", True, []),
        ("it's -r out:=there", True, [("out", "there")]),
    ],
)
def test_the_rules_in_arguments(arguments, ros, rules):
    assert list(parse_remap_rules(arguments, in_ros_args=ros)) == rules


@given(st.text(), st.booleans())
def test_any_arguments_give_rules_or_none(arguments, ros):
    assert all(name and target for name, target in parse_remap_rules(arguments, in_ros_args=ros))
