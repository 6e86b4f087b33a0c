"""Who may do what: the paper's Executor column, every cell of it."""

from dataclasses import fields, replace
from itertools import chain, combinations

import pytest
from controller_setup import PLAN, plan, plan_with

from rtron.coherence import EffectivePlan
from rtron.service.domain.principal import Right, UserRole
from rtron.service.domain.rights import (
    coordination_kinds,
    granted_rights,
    mandatory_violations,
    missing_rights,
    needed_rights,
)
from rtron.vocabulary import (
    CoordinationKind,
    FlowSettings,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
)

DEV, USER, ADMIN = UserRole.DEVELOPER, UserRole.END_USER, UserRole.ADMIN
GRCN, RSRCN, MSRCN = CoordinationKind.GRCN, CoordinationKind.RSRCN, CoordinationKind.MSRCN
# (paper, table of policies): who may what, each line a right, each column a kind.
MATRIX = {
    Right.SELECT_POLICY: {GRCN: {DEV}, RSRCN: {USER}, MSRCN: {USER}},
    Right.SET_PRIORITY: {GRCN: {DEV}, RSRCN: {DEV}},
    Right.SET_BLOCK: {GRCN: {DEV}, RSRCN: {DEV}, MSRCN: {USER}},
    Right.SET_TIMEOUT: {GRCN: {DEV}},
    Right.SET_DURATIONS: {GRCN: {DEV}},
    Right.SET_THRESHOLD: {RSRCN: {DEV}},
    Right.SET_MAX_VEL_LIMIT: {RSRCN: {USER}},
    Right.SELECT_RULES: {MSRCN: {USER}},
    Right.SET_RULES: {MSRCN: {USER}},
    Right.OVERRIDE: {RSRCN: {DEV, USER}, MSRCN: {DEV, USER}},
}
ROLES = [set(some) for some in chain.from_iterable(combinations(UserRole, n) for n in range(4))]
IDS = {GRCN: "drive", RSRCN: "speed", MSRCN: "mission"}
# What each setting takes, and one value of it.
NODE = {
    "policy": (Right.SELECT_POLICY, PolicyName.BLOCK),
    "release_after": (Right.SET_DURATIONS, 5),
    "max_age": (Right.SET_DURATIONS, 5),
    "max_hold": (Right.SET_DURATIONS, 5),
    "threshold": (Right.SET_THRESHOLD, 0.1),
    "max_vel_limit": (Right.SET_MAX_VEL_LIMIT, 0.1),
    "flows": (None, None),
    "rules": (None, None),
}
FLOW = {
    "priority": (Right.SET_PRIORITY, 7),
    "block": (Right.SET_BLOCK, True),
    "timeout": (Right.SET_TIMEOUT, 5),
}
RULE = {
    "selected": (Right.SELECT_RULES, False),
    "block": (Right.SET_RULES, ("/goal",)),
    "when": (Right.SET_RULES, "night"),
}


@pytest.mark.parametrize("kind", CoordinationKind)
@pytest.mark.parametrize("right", Right)
def test_the_matrix(right, kind):
    allowed = MATRIX[right].get(kind, set())
    for roles in ROLES:
        assert (right in granted_rights(roles, kind)) is bool(roles & allowed), roles


def test_every_right_is_somebodys():
    assert MATRIX.keys() == set(Right)


@pytest.mark.parametrize(
    ("noun", "table"), [(NodeSettings, NODE), (FlowSettings, FLOW), (RuleSettings, RULE)]
)
def test_every_setting_is_in_these_tables(noun, table):
    assert {each.name for each in fields(noun)} == table.keys()


def cases():
    for kind, id in IDS.items():
        for key, (right, value) in NODE.items():
            if right:
                yield kind, right, Settings(nodes={id: NodeSettings(**{key: value})})
        for key, (right, value) in FLOW.items():
            flows = {"any": FlowSettings(**{key: value})}
            yield kind, right, Settings(nodes={id: NodeSettings(flows=flows)})
        for key, (right, value) in RULE.items():
            rules = {"any": RuleSettings(**{key: value})}
            yield kind, right, Settings(nodes={id: NodeSettings(rules=rules)})


@pytest.mark.parametrize(("kind", "right", "after"), list(cases()))
def test_a_setting_takes_its_right_to_make_and_to_take_back(kind, right, after):
    needed = {(IDS[kind], right)}
    assert needed_rights(plan(), Settings(), after) == needed
    assert needed_rights(plan(), after, Settings()) == needed
    assert needed_rights(plan(), after, replace(after, revision=9)) == set()


@pytest.mark.parametrize(("kind", "right", "after"), list(cases()))
def test_what_is_missing_is_what_the_matrix_denies(kind, right, after):
    needed = needed_rights(plan(), Settings(), after)
    for roles in ROLES:
        denied = not roles & MATRIX[right].get(kind, set())
        assert missing_rights(plan(), roles, needed) == [(IDS[kind], right)] * denied, roles


def test_what_stays_takes_no_right():
    before = Settings(nodes={"drive": NodeSettings(flows={"flow1": FlowSettings(priority=7)})})
    flows = {"flow1": FlowSettings(priority=7, block=True)}
    after = Settings(nodes={"drive": NodeSettings(flows=flows)})
    assert needed_rights(plan(), before, after) == {("drive", Right.SET_BLOCK)}


def test_several_nodes_take_the_rights_of_each():
    after = Settings(
        nodes={
            "drive": NodeSettings(policy=PolicyName.BLOCK),
            "speed": NodeSettings(policy=PolicyName.BLOCK, threshold=1.0),
        }
    )
    needed = needed_rights(plan(), Settings(), after)
    assert missing_rights(plan(), {DEV}, needed) == [("speed", Right.SELECT_POLICY)]
    assert missing_rights(plan(), {DEV, USER}, needed) == []


def test_the_kinds_are_those_with_a_policy():
    assert coordination_kinds(plan()) == {"drive": GRCN, "speed": RSRCN, "mission": MSRCN}


POLICIES = [PolicyName.BLOCK, PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN]
BOTH = {PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN}


@pytest.mark.parametrize("wanted", POLICIES)
@pytest.mark.parametrize("mandatory", POLICIES)
def test_a_mandatory_policy_cannot_be_deselected(mandatory, wanted):
    given = plan_with("policy: Safe", f"policy: {mandatory}\n  mandatory: {mandatory}")
    after = Settings(nodes={"speed": NodeSettings(policy=wanted)})
    includes = wanted is mandatory or (wanted is PolicyName.SAFE_CONSTRAIN and mandatory in BOTH)
    told = list(mandatory_violations(EffectivePlan(given, after)))
    assert bool(told) is not includes
    assert not told or told == [f"{mandatory} of speed is mandatory: {wanted} would deselect it"]


@pytest.mark.parametrize("limit", [1e-6, 0.499, 0.5])
def test_a_mandatory_limit_can_be_lowered(limit):
    given = plan_with("policy: Safe", "policy: Constrain\n  mandatory: Constrain")
    after = Settings(nodes={"speed": NodeSettings(max_vel_limit=limit)})
    assert list(mandatory_violations(EffectivePlan(given, after))) == []


@pytest.mark.parametrize("policy", ["Constrain", "Safe+Constrain"])
@pytest.mark.parametrize("limit", [0.5000001, 0.6, 1000.0])
def test_a_mandatory_limit_cannot_be_raised(limit, policy):
    given = plan_with("policy: Safe", f"policy: {policy}\n  mandatory: {policy}")
    after = Settings(nodes={"speed": NodeSettings(max_vel_limit=limit)})
    (told,) = mandatory_violations(EffectivePlan(given, after))
    assert told.endswith("max_vel_limit is at most 0.5 m/s")


@pytest.mark.parametrize(
    ("threshold", "is_raised"), [(0.001, False), (0.02, False), (0.0200001, True)]
)
@pytest.mark.parametrize("policy", ["Safe", "Safe+Constrain"])
def test_a_mandatory_threshold_can_be_lowered_not_raised(policy, threshold, is_raised):
    given = plan_with("policy: Safe", f"policy: {policy}\n  mandatory: {policy}")
    after = Settings(nodes={"speed": NodeSettings(threshold=threshold)})
    told = f"{policy} of speed is mandatory: threshold is at most 0.02 m/frame"
    assert list(mandatory_violations(EffectivePlan(given, after))) == [told] * is_raised


@pytest.mark.parametrize("mandatory", ["", "\n  mandatory: Constrain", "\n  mandatory: Block"])
def test_another_threshold_can_be_raised(mandatory):
    policy = "Block" if "Block" in mandatory else "Safe+Constrain"
    given = plan_with("policy: Safe", f"policy: {policy}{mandatory}")
    after = Settings(nodes={"speed": NodeSettings(threshold=0.9)})
    assert list(mandatory_violations(EffectivePlan(given, after))) == []


@pytest.mark.parametrize("mandatory", ["", "\n  mandatory: Safe"])
def test_another_limit_can_be_raised(mandatory):
    given = plan_with("policy: Safe", f"policy: Safe+Constrain{mandatory}")
    after = Settings(nodes={"speed": NodeSettings(max_vel_limit=0.9)})
    assert list(mandatory_violations(EffectivePlan(given, after))) == []


@pytest.mark.parametrize(
    ("own", "told"),
    [
        (RuleSettings(), ""),
        (RuleSettings(selected=True), ""),
        (RuleSettings(block=("/goal",)), ""),
        (RuleSettings(block=("aflow2", "aflow1")), ""),
        (RuleSettings(selected=False), "it cannot be deselected"),
        (RuleSettings(when="night || alone"), "its condition stays as the plan says"),
        (RuleSettings(when="night && alone"), "its condition stays as the plan says"),
        (RuleSettings(block=("aflow1",)), "what it blocks stays blocked"),
    ],
)
def test_a_mandatory_rule_is_not_weakened(own, told):
    after = Settings(nodes={"mission": NodeSettings(rules={"quiet": own})})
    expected = [f"the rule quiet of mission is mandatory: {told}"] if told else []
    assert list(mandatory_violations(EffectivePlan(plan(), after))) == expected


@pytest.mark.parametrize("own", [RuleSettings(selected=False), RuleSettings(when="night")])
def test_another_rule_is_the_end_users(own):
    after = Settings(nodes={"mission": NodeSettings(rules={"watched": own})})
    assert list(mandatory_violations(EffectivePlan(plan(), after))) == []


def test_a_plan_without_them_makes_nothing_mandatory():
    given = plan(PLAN[: PLAN.index("rsrcn:")])
    assert list(mandatory_violations(EffectivePlan(given, Settings()))) == []
