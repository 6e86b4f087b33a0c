"""Rules that cannot be kept together are refused, all of them with their lines."""

import re
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cpu_time import work_units
from rtron.errors import PlanError
from rtron.messages.expressions.condition import Condition
from rtron.planning import ProblemLevel, check_plan, parse_plan
from rtron.planning.rule_contradictions import contradictions
from rtron.vocabulary import MSRCN, Flow, GuardedTopic, MissionRule, Mode, Plan, PolicyName

HEAD = """\
msrcn:
  mode: enforce
  aflows:
    - topic: /cmd_vel
      type: geometry_msgs/Twist
      flows: [{name: v1, publisher: /a}, {name: v2, publisher: /b}]
    - {topic: /goal, flows: [{name: G, publisher: /c}]}
    - {topic: /alert, flows: [{name: S, publisher: /d}]}
  eflows:
"""
FIRST = 24


def mission(*rules: str, events: str = "abcdefghijklm") -> str:
    """Return a plan in which the rules stand one a line, the first on line FIRST."""
    names = [
        f"    - {{name: {e}, topic: /{e}, publisher: /{e}_sensor, present: 1}}\n" for e in events
    ]
    written = (f"    - {{name: r{n}, {rule}}}\n" for n, rule in enumerate(rules, start=1))
    return f"{HEAD}{''.join(names)}  rules:\n{''.join(written)}"


def faults(*rules: str) -> list[str]:
    with pytest.raises(PlanError) as caught:
        parse_plan(mission(*rules), "my.yaml")
    return str(caught.value).splitlines()


def doubts(*rules: str) -> list[str]:
    return [str(problem) for problem in check_plan(parse_plan(mission(*rules)))]


def test_the_lines_are_as_said():
    assert mission("when: a, block: [G]").splitlines()[FIRST - 1].strip().startswith("- {name: r1")


@pytest.mark.parametrize(
    "rules",
    [
        ["when: a, block: [/cmd_vel]"],
        ["when: a, block: [/cmd_vel]", "when: b, block: [/cmd_vel]"],
        ["when: a, block: [/cmd_vel]", "when: '!a', block: [/goal]"],
        ["when: a, block: [v1]", "when: '!a', block: [v2]"],
        ["when: a && b, block: [/cmd_vel]", "when: '!a && !b', block: [/cmd_vel]"],
        ["when: a, block: [/cmd_vel]", "when: '!a', block: [/cmd_vel], require: S"],
        ["when: a, block: [v1]", "when: '!a', block: [v1], action: action.linear.x > 0.1"],
        ["block: [/cmd_vel]"],
        ["block: [/cmd_vel], action: action.linear.x > 0.1"],
        ["block: [/cmd_vel], require: S"],
        ["when: a, block: [/cmd_vel], require: b"],
        ["when: a, block: [v1], require: /cmd_vel"],
        ["when: a, block: [G], require: S", "when: b, block: [v1], require: S"],
        ["when: a, block: [G], require: S", "when: '!a', block: [S]"],
        ["when: a, block: [G], require: S", "when: a, block: [S], require: v1"],
        ["when: a, block: [G], require: /cmd_vel", "when: a, block: [v1]"],
        ["when: a, block: [G], require: v1", "when: a, block: [v1], action: action.linear.x > 1.0"],
    ],
)
def test_rules_that_can_be_kept(rules):
    assert doubts(*rules) == []


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        (
            ["when: a, block: [/cmd_vel]", "when: '!a', block: [/cmd_vel]"],
            dict.fromkeys((0, 1), "with r1 and r2, nothing passes on /cmd_vel, whatever happens"),
        ),
        (
            ["when: a || !a, block: [/cmd_vel]"],
            {0: "with r1, nothing passes on /cmd_vel, whatever happens"},
        ),
        (
            [
                "when: a, block: [/cmd_vel, G]",
                "when: c, block: [v1]",
                "when: '!a && b', block: [v1]",
                "when: '!b', block: [v1]",
            ],
            dict.fromkeys((0, 2, 3), "with r1 and r3 and r4, nothing passes on v1, what"),
        ),
        (
            ["when: a, block: [/cmd_vel, /goal]", "when: '!a', block: [G, v1, v2]"],
            dict.fromkeys((0, 1), "with r1 and r2, nothing passes on /cmd_vel and /goal, what"),
        ),
        (["when: a && !a, block: [G]"], {0: "this can never hold"}),
        (["when: 'false', block: [G]"], {0: "this can never hold"}),
        (["when: a && 'false', block: [G]".replace("'", "")], {0: "this can never hold"}),
        (
            ["when: a, block: [G], require: S", "when: a || b, block: [/alert]"],
            {0: "S is required and can never speak: r2 blocks it"},
        ),
        (
            ["when: a, block: [G], require: /cmd_vel", "block: [/cmd_vel]"],
            {0: "/cmd_vel is required and can never speak: r2 blocks it"},
        ),
        (
            [
                "when: a, block: [G], require: /cmd_vel",
                "when: a, block: [v1]",
                "when: a, block: [v2]",
            ],
            {0: "/cmd_vel is required and can never speak: r2 and r3 blocks it"},
        ),
        (
            ["when: a, block: [G], require: S", "when: a, block: [S], require: G"],
            {
                0: "S is required and can never speak: r2 blocks it",
                1: "G is required and can never speak: r1 blocks it",
            },
        ),
    ],
)
def test_rules_that_cannot_be_kept(rules, told):
    found = faults(*rules)
    assert len(found) == len(told)
    for text, (number, message) in zip(found, told.items(), strict=True):
        assert text.startswith(f"my.yaml:{FIRST + number}: {message}")


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        (
            ["block: [/cmd_vel]", "when: a, block: [v1]"],
            "warning: MSRCN, rule r2: this rule changes nothing: r1 always blocks",
        ),
        (
            ["when: a || true, block: [/cmd_vel]", "when: a, block: [v1]"],
            "warning: MSRCN, rule r2: this rule changes nothing: r1 always blocks",
        ),
        (
            ["when: a, block: [G], require: S", "when: b, block: [/alert]"],
            "warning: MSRCN, rule r1: S is required and can not always speak: r2 blocks it",
        ),
        (
            ["when: a, block: [G], require: S", "when: b, block: [S], require: G"],
            "warning: MSRCN, rule r1: S is required and can not always speak: r2 blocks it",
        ),
    ],
)
def test_what_is_odd_but_may_be_meant_is_a_warning(rules, told):
    assert told in doubts(*rules)


def test_a_bit_of_every_event_can_be_involved():
    twelve = " && ".join("abcdefghijkl")
    assert faults(f"when: {twelve}, block: [G]", f"when: '!({twelve})', block: [G]")
    assert doubts(f"when: {twelve}, block: [G]") == []


def test_with_more_than_twelve_eflows_it_says_that_it_did_not_try():
    thirteen = " && ".join("abcdefghijklm")
    assert doubts(f"when: {thirteen}, block: [G]", f"when: '!({thirteen})', block: [G]") == [
        (
            "warning: MSRCN, rule r1: this rule and 1 more with the same aflows depend on 13 "
            "eflows: whether they contradict was not tried"
        )
    ]


def test_rules_on_other_aflows_are_tried_apart():
    rules = [f"when: {' && '.join('abcdefgh')}, block: [G]", "when: i && !j && k, block: [v1]"]
    assert doubts(*rules, "when: l || m, block: [S]") == []
    assert faults(*rules, "when: l && !l, block: [S]") == [
        f"my.yaml:{FIRST + 2}: this can never hold"
    ]


def test_very_many_rules_are_tried_in_bounded_time():
    rules = [f"when: {' && '.join('abcdefghijkl')}, block: [G, v1], require: S"] * 200
    several = [
        f"when: '{'abcdefghijkl'[n % 12]}', block: [{'GS'[n % 2]}], require: {'SG'[n % 2]}"
        for n in range(200)
    ]
    for all_rules, count in ((rules, 1), (several, 200)):
        found, units = work_units(doubts, *all_rules)
        assert len(found) == count
        assert units < 100


# The same again, the slow and plain way: each combination of bits is looked at by itself.
FLOWS = {"/cmd_vel": {"v1", "v2"}, "/goal": {"G"}, "/alert": {"S"}}
NAMED = FLOWS | {name: {name} for flows in FLOWS.values() for name in flows}
BITS = [dict(zip("abc", bits, strict=True)) for bits in product((False, True), repeat=3)]
conditions = st.sampled_from(
    ["true", "a", "!a", "b", "!b", "a && b", "!(a && b)", "a || b || c", "c && !c", "a || !a", "c"]
)
rules = st.builds(
    MissionRule,
    name=st.just("r"),
    block=st.lists(st.sampled_from(sorted(NAMED)), min_size=1, max_size=2).map(tuple),
    when=conditions,
    action=st.sampled_from(["", "", "", "action.linear.x > 1.0"]),
    require=st.sampled_from(["", "", "S", "G", "/cmd_vel", "v1", "a"]),
)
missions = st.lists(rules, min_size=1, max_size=5).map(
    lambda made: [replace(rule, name=f"r{n}") for n, rule in enumerate(made)]
)


def blocks(rule: MissionRule) -> set[str]:
    return set().union(*(NAMED[name] for name in rule.block))


def holding(mission: list[MissionRule], bits: dict[str, bool]) -> list[MissionRule]:
    return [rule for rule in mission if Condition(rule.when, "abc").holds(bits)]


def staying(mission: list[MissionRule], bits: dict[str, bool]) -> list[MissionRule]:
    """Return the rules that stay when every obligation has been met that can be."""
    left = holding(mission, bits)
    while True:
        blocked = set().union(*(blocks(rule) for rule in left if not rule.action))
        met = [r for r in left if r.require and not NAMED.get(r.require, {"a"}) <= blocked]
        if not met:
            return left
        left = [rule for rule in left if rule not in met]


def never_passing(mission: list[MissionRule]) -> set[str]:
    stoppers = [rule for rule in mission if not rule.action and not rule.require]
    always = [rule for rule in stoppers if not Condition(rule.when, "abc").names]
    deliberate = set().union(*(blocks(r) for r in always if holding([r], BITS[0])))
    each = [set().union(*map(blocks, holding(stoppers, bits))) for bits in BITS]
    return set.intersection(*each) - deliberate


def found_in(mission: list[MissionRule]) -> list[tuple[ProblemLevel, MissionRule, str]]:
    topics = tuple(
        GuardedTopic(
            topic=topic,
            type="",
            flows=tuple(Flow(name=name, publisher=f"/{name}") for name in sorted(flows)),
        )
        for topic, flows in FLOWS.items()
    )
    msrcn = MSRCN(
        id="m", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=topics, rules=tuple(mission)
    )
    return list(contradictions(msrcn, {r.name: Condition(r.when, "abc") for r in mission}))


@given(missions)
def test_what_is_found_is_what_each_combination_by_itself_shows(mission):
    found = found_in(mission)
    told = [re.search(r"nothing passes on (.*), what", text) for _, _, text in found]
    silent = {name for match in told if match for name in match[1].split(" and ")}
    assert set().union(*(NAMED[name] for name in silent)) == never_passing(mission)
    stuck = {rule.name: 0 for rule in mission}
    for bits in BITS:
        for rule in staying(mission, bits):
            stuck[rule.name] += rule.require in NAMED
    for rule in mission:
        held = sum(bool(holding([rule], bits)) for bits in BITS)
        levels = {level for level, one, text in found if one is rule and "is required" in text}
        wanted = ProblemLevel.ERROR if stuck[rule.name] == held else ProblemLevel.WARNING
        assert levels == ({wanted} if stuck[rule.name] else set())
        never = (ProblemLevel.ERROR, rule, "this can never hold") in found
        assert never == (held == 0)


def test_a_plan_without_a_mission_has_no_doubts():
    assert check_plan(Plan(app="")) == ()
