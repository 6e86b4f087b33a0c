"""From a plan and settings to the plan in force."""

from dataclasses import fields, replace

import pytest
from plans import grcn, plan_of

from rtron.coherence import (
    EffectivePlan,
    SettingsMismatchError,
    compatible_settings,
    coordination_node_ids,
)
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    EmergencyStop,
    Flow,
    FlowSettings,
    FpsMonitor,
    GuardedTopic,
    MissionRule,
    Mode,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
    TimedOverride,
)


def topic(name, *flows):
    made = tuple(Flow(name=flow, publisher=f"/{flow}") for flow in flows)
    return GuardedTopic(topic=name, type="", flows=made)


PLAN = replace(
    plan_of(grcn("/cmd_vel", ("/a", "/b"), ("/c",))),
    rsrcn=RSRCN(
        id="speed",
        mode=Mode.ENFORCE,
        policy=PolicyName.SAFE,
        threshold=0.1,
        vflows=(topic("/max_vel", "v1"), topic("/max_vel2", "v2")),
    ),
    msrcn=MSRCN(
        id="mission",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(topic("/goal", "a1", "a2"),),
        rules=(
            MissionRule(name="one", block=("a1",), when="e"),
            MissionRule(name="two", block=("a2",)),
        ),
    ),
    fps_monitor=(FpsMonitor(id="eyes", node="/eye", topic="/image"),),
)
GRCN_ID = PLAN.grcn[0].id


def in_force(settings):
    """Return the plan in force, or raise."""
    return EffectivePlan(PLAN, settings).plan


def one(id, **keys):
    return Settings(revision=7, nodes={id: NodeSettings(**keys)})


def test_no_settings_are_the_plan():
    assert in_force(Settings()) == PLAN
    assert in_force(Settings(revision=7)) == replace(PLAN, revision=7)


def test_overrides_and_the_stop_change_no_policy():
    override = TimedOverride(by="me", reason="why", until=1)
    stop = EmergencyStop(by="me", reason="why", at=1)
    assert in_force(Settings(overrides={"speed": override}, stop=stop)) == PLAN


def test_a_grcn_with_all_that_can_be_set():
    flows = {"flow2": FlowSettings(priority=0, block=False, timeout=0)}
    keys = {"policy": PolicyName.BLOCK, "release_after": 0, "max_age": 1, "max_hold": 2}
    (after,) = in_force(one(GRCN_ID, flows=flows, **keys)).grcn
    before = PLAN.grcn[0]
    second = replace(before.flows[1], priority=0, block=False, timeout=0)
    assert after == replace(before, flows=(before.flows[0], second), **keys)


def test_an_rsrcn_with_all_that_can_be_set():
    keys = {"policy": PolicyName.CONSTRAIN, "threshold": 0.2, "max_vel_limit": 0.3}
    after = EffectivePlan(
        PLAN, one("speed", flows={"v2": FlowSettings(block=True)}, **keys)
    ).plan.rsrcn
    assert [flow.block for each in after.vflows for flow in each.flows] == [False, True]
    assert replace(after, vflows=PLAN.rsrcn.vflows) == replace(PLAN.rsrcn, **keys)


@pytest.mark.parametrize(
    ("rules", "left"),
    [
        ({}, PLAN.msrcn.rules),
        ({"one": RuleSettings(selected=True)}, PLAN.msrcn.rules),
        ({"one": RuleSettings(selected=False)}, PLAN.msrcn.rules[1:]),
        (
            {"one": RuleSettings(when="x")},
            (MissionRule(name="one", block=("a1",), when="x"), PLAN.msrcn.rules[1]),
        ),
        (
            {"one": RuleSettings(block=("a2",))},
            (MissionRule(name="one", block=("a2",), when="e"), PLAN.msrcn.rules[1]),
        ),
        (
            {"own": RuleSettings(when="x", block=("a1",))},
            (*PLAN.msrcn.rules, MissionRule(name="own", when="x", block=("a1",))),
        ),
        ({"own": RuleSettings(when="x", block=("a1",), selected=False)}, PLAN.msrcn.rules),
    ],
)
def test_the_rules_of_the_mission(rules, left):
    assert in_force(one("mission", rules=rules)).msrcn.rules == left


NODE_KEYS = {
    "policy": PolicyName.BLOCK,
    "release_after": 1,
    "max_age": 1,
    "max_hold": 1,
    "threshold": 1.0,
    "max_vel_limit": 1.0,
}
ALLOWED = {
    GRCN_ID: {"policy", "release_after", "max_age", "max_hold"},
    "speed": {"policy", "threshold", "max_vel_limit"},
    "mission": {"policy"},
}


def test_all_settings_are_tried():
    assert {each.name for each in fields(NodeSettings)} == {*NODE_KEYS, "flows", "rules"}


@pytest.mark.parametrize("id", ALLOWED)
@pytest.mark.parametrize("key", NODE_KEYS)
def test_a_setting_is_for_its_kind_of_node(id, key):
    settings = one(id, **{key: NODE_KEYS[key]})
    if key in ALLOWED[id]:
        in_force(settings)
    else:
        with pytest.raises(SettingsMismatchError, match=f"^no setting of {id} is called {key}: "):
            in_force(settings)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (one("spead"), "no coordination node is called spead: did you mean speed?"),
        (one("eyes"), "no coordination node is called eyes: choose from"),
        (
            one(GRCN_ID, flows={"flow3": FlowSettings()}),
            f"no flow of {GRCN_ID} is called flow3: did you",
        ),
        (
            one("speed", flows={"flow1": FlowSettings()}),
            "no flow of speed is called flow1: choose from",
        ),
        (one("mission", flows={"v1": FlowSettings()}), "no flow of mission is called v1"),
        (one("speed", rules={"one": RuleSettings()}), "speed has no rules"),
        (one("mission", rules={"own": RuleSettings(when="x")}), "mission has no rule own"),
    ],
)
def test_what_the_plan_does_not_have(settings, told):
    with pytest.raises(SettingsMismatchError) as caught:
        in_force(settings)
    assert told in str(caught.value)
    left, lost = compatible_settings(PLAN, settings)
    assert (left, lost) == (Settings(revision=7), (str(caught.value),))


def test_a_long_name_is_told_in_short():
    with pytest.raises(SettingsMismatchError) as caught:
        in_force(one("speed", flows={"f" * 1_000_000: FlowSettings()}))
    assert len(str(caught.value)) < 200


def test_what_fits_stays_under_another_plan():
    override = TimedOverride(by="me", reason="why", until=1)
    good = {"speed": NodeSettings(threshold=0.5)}
    settings = Settings(
        revision=7,
        nodes={**good, "gone": NodeSettings()},
        overrides={"speed": override, "gone": override},
        stop=EmergencyStop(by="me", reason="why", at=1),
    )
    left, lost = compatible_settings(PLAN, settings)
    assert left == replace(settings, nodes=good, overrides={"speed": override})
    assert lost[1] == "gone has an override"
    assert len(lost) == 2


def test_a_grcn_is_never_overridden():
    override = TimedOverride(by="me", reason="why", until=1)
    left, lost = compatible_settings(
        PLAN, Settings(overrides={GRCN_ID: override, "mission": override})
    )
    assert (left, lost) == (
        Settings(overrides={"mission": override}),
        (f"{GRCN_ID} has an override",),
    )


def test_the_ids_are_those_of_nodes_with_a_policy():
    assert coordination_node_ids(PLAN) == (GRCN_ID, "speed", "mission")
    assert coordination_node_ids(replace(PLAN, rsrcn=None, msrcn=None)) == (GRCN_ID,)
