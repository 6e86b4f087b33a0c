"""A change of settings merged in: what is given, what is taken back, what is refused."""

import math

import pytest
from controller_setup import plan
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import InputError
from rtron.service.domain.settings_patch import MAX_BLOCKED, MAX_USER_RULES, merge_patch
from rtron.vocabulary import SECOND, FlowSettings, NodeSettings, PolicyName, RuleSettings, Settings

PLAN = plan()
DAY = 24 * 3600 * SECOND
TOPIC_OR_FLOW = "a full topic name like /cmd_vel or the name of a flow"


def merged_nodes(nodes, before=None):
    return merge_patch(PLAN, before or Settings(revision=4), nodes)


def refused(nodes):
    with pytest.raises(InputError) as caught:
        merged_nodes(nodes)
    return str(caught.value), caught.value.help


def test_each_key_is_taken():
    after = merged_nodes(
        {
            "drive": {
                "policy": "Priority_Queue",
                "release_after": "200 ms",
                "max_age": 7,
                "max_hold": "2 min",
                "flows": {"flow1": {"priority": -3, "block": True, "timeout": "0.5"}},
            },
            "speed": {"threshold": "2 cm/frame", "max_vel_limit": 0.3},
            "mission": {"rules": {"watched": {"selected": False, "block": ["/goal"]}}},
        }
    )
    flow = FlowSettings(priority=-3, block=True, timeout=SECOND // 2)
    rule = RuleSettings(selected=False, block=("/goal",))
    assert after.revision == 4
    assert after.nodes == {
        "drive": NodeSettings(
            policy=PolicyName.PRIORITY_QUEUE,
            release_after=SECOND // 5,
            max_age=7,
            max_hold=120 * SECOND,
            flows={"flow1": flow},
        ),
        "speed": NodeSettings(threshold=0.02, max_vel_limit=0.3),
        "mission": NodeSettings(rules={"watched": rule}),
    }


BEFORE = Settings(
    nodes={
        "drive": NodeSettings(
            policy=PolicyName.BLOCK,
            flows={
                "flow1": FlowSettings(priority=5, block=True),
                "flow2": FlowSettings(priority=6),
            },
        )
    }
)


@pytest.mark.parametrize(
    ("patch", "left"),
    [
        ({}, BEFORE.nodes["drive"]),
        ({"policy": None}, NodeSettings(flows=BEFORE.nodes["drive"].flows)),
        ({"flows": None}, NodeSettings(policy=PolicyName.BLOCK)),
        ({"flows": {"flow1": None, "flow2": None}}, NodeSettings(policy=PolicyName.BLOCK)),
        ({"flows": {}}, BEFORE.nodes["drive"]),
        (
            {"flows": {"flow1": {"priority": None}, "flow2": None}},
            NodeSettings(policy=PolicyName.BLOCK, flows={"flow1": FlowSettings(block=True)}),
        ),
    ],
)
def test_null_takes_back_and_the_rest_stays(patch, left):
    assert merged_nodes({"drive": patch}, BEFORE).nodes == {"drive": left}


def test_what_differs_in_nothing_is_not_kept():
    assert merged_nodes({"drive": {"policy": None, "flows": None}}, BEFORE).nodes == {}


@pytest.mark.parametrize(
    ("nodes", "told", "help"),
    [
        ({"drivee": {}}, "no coordination node is called 'drivee'", "did you mean drive?"),
        (
            {"drive": {"polcy": "Block"}},
            "no setting of drive is called 'polcy'",
            "did you mean policy?",
        ),
        (
            {"drive": {"flows": {"flow1": {"prio": 3}}}},
            "no setting of drive.flows.flow1 is called 'prio'",
            "did you mean priority?",
        ),
        (
            {"drive": {"policy": "Preemtion"}},
            "drive.policy: unknown word 'Preemtion': did you mean Preemption?",
            "",
        ),
        ({"drive": {"policy": 3}}, "drive.policy: '3' is no text", ""),
        ({"drive": {"flows": [1]}}, "drive.flows is an object", "flows: {name: …}, or null"),
        (
            {"drive": {"flows": {"flow1": 3}}},
            "drive.flows.flow1 is an object",
            "flow1: {name: …}, or null",
        ),
        (
            {"mission": {"rules": {"a b": {"when": "night"}}}},
            "mission.rules: 'a b' is not a word of letters, digits and _",
            "",
        ),
        (
            {"mission": {"rules": {"own": {"block": []}}}},
            "mission.rules.own.block: a list of at least one aflow or topic",
            "",
        ),
        (
            {"mission": {"rules": {"own": {"block": ["a b"]}}}},
            f"mission.rules.own.block: 'a b' is not {TOPIC_OR_FLOW}",
            "",
        ),
        (
            {"mission": {"rules": {"own": {"block": "/goal"}}}},
            "mission.rules.own.block: a list of at least one aflow or topic",
            "",
        ),
    ],
)
def test_what_is_unknown_is_refused_with_the_nearest_word(nodes, told, help):
    assert refused(nodes) == (told, help)


GOOD = {
    "priority": {value: value for value in (-(2**31), 0, 2**31 - 1)},
    "timeout": {0: 0, 1: 1, DAY: DAY, "0": 0, "1 ns": 1, "0.2 s": SECOND // 5, "24 h": DAY},
    "block": {True: True, False: False},
}
BAD = {
    "priority": [-(2**31) - 1, 2**31, 1.0, "1", True, [], 10**400],
    "timeout": [-1, DAY + 1, 2**63, 0.5, True, "-1", "1 parsec", "nan", {}, "0.1 ns"],
    "block": [0, 1, "true", "", []],
}


@pytest.mark.parametrize(
    ("key", "value", "taken"), [(key, *pair) for key in GOOD for pair in GOOD[key].items()]
)
def test_a_flows_values_within_bounds(key, value, taken):
    after = merged_nodes({"drive": {"flows": {"flow1": {key: value}}}})
    assert after.nodes["drive"].flows["flow1"] == FlowSettings(**{key: taken})


@pytest.mark.parametrize(("key", "value"), [(k, v) for k in BAD for v in BAD[k]])
def test_a_flows_values_out_of_bounds(key, value):
    told, _ = refused({"drive": {"flows": {"flow1": {key: value}}}})
    assert told.startswith(f"drive.flows.flow1.{key}: ")
    assert len(told) < 300


@pytest.mark.parametrize("value", [1e-6, 0.22, 1, 1000, 1000.0, "0.22 m/s", "0.8 km/h", "22 cm/s"])
def test_a_limit_is_finite_and_positive(value):
    limit = merged_nodes({"speed": {"max_vel_limit": value}}).nodes["speed"].max_vel_limit
    assert limit > 0


@pytest.mark.parametrize(
    "value",
    [0, 0.0, -0.1, 1e-7, 1000.1, math.nan, math.inf, -math.inf, 10**30, "fast", "0 m/s", True, []],
)
def test_another_limit_is_refused(value):
    told, _ = refused({"speed": {"max_vel_limit": value}})
    assert told.startswith("speed.max_vel_limit: ")


def rules(count, start=0):
    own = {"when": "night", "block": ["/goal"]}
    return {"mission": {"rules": {f"own{i}": own for i in range(start, start + count)}}}


def test_own_rules_are_counted():
    most = merged_nodes(rules(MAX_USER_RULES))
    assert len(most.nodes["mission"].rules) == MAX_USER_RULES
    with pytest.raises(InputError, match=f"more than {MAX_USER_RULES} rules of your own"):
        merged_nodes(rules(1, start=MAX_USER_RULES), most)
    replaced = {"mission": {"rules": {"own0": None, **rules(1, start=99)["mission"]["rules"]}}}
    assert len(merged_nodes(replaced, most).nodes["mission"].rules) == MAX_USER_RULES


def test_the_plans_rules_are_not_counted():
    most = merged_nodes(rules(MAX_USER_RULES))
    more = merged_nodes({"mission": {"rules": {"quiet": {"selected": True}}}}, most)
    assert more.nodes["mission"].rules["quiet"].selected
    assert len(more.nodes["mission"].rules) == MAX_USER_RULES + 1


@pytest.mark.parametrize(
    ("longest", "length"), [("name", 255), ("when", 4096), ("block", MAX_BLOCKED)]
)
def test_names_and_expressions_are_bounded(longest, length):
    def own(size):
        name = "n" * size if longest == "name" else "own"
        when = "(" * size if longest == "when" else "night"
        block = [f"f{i}" for i in range(size)] if longest == "block" else ["/goal"]
        return {"mission": {"rules": {name: {"when": when, "block": block}}}}

    ((name, rule),) = merged_nodes(own(length)).nodes["mission"].rules.items()
    sizes = {"name": len(name), "when": len(rule.when or ""), "block": len(rule.block or ())}
    assert sizes[longest] == length
    told, _ = refused(own(length + 1))
    assert len(told) < 400


def test_a_block_names_each_once():
    own = {"mission": {"rules": {"own": {"block": ["/goal", "/goal"]}}}}
    assert merged_nodes(own).nodes["mission"].rules["own"].block == ("/goal",)


WORDS = st.sampled_from(
    ["drive", "mission", "policy", "flows", "rules", "flow1", "own", "block", "when", "", "x\ud800"]
)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, max_size=3),
    max_leaves=10,
)


@given(st.dictionaries(WORDS, st.dictionaries(WORDS, JSON, max_size=4), max_size=3))
def test_anything_is_merged_or_refused(nodes):
    try:
        told, known = "", set(merged_nodes(nodes).nodes)
    except InputError as error:
        told, known = str(error), set()
    assert len(told.encode(errors="strict")) < 1000
    assert known <= {"drive", "mission"}
