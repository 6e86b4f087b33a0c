"""Settings are checked as a plan is, before they go out."""

import re

import pytest
from controller_setup import PLAN, plan, plan_with

from rtron.coherence import EffectivePlan
from rtron.errors import InputError
from rtron.service.domain.settings_checks import check_settings, drop_misfits
from rtron.vocabulary import (
    FlowSettings,
    NodeSettings,
    PolicyName,
    RuleSettings,
    Settings,
    TimedOverride,
)


def node(id, **keys):
    return Settings(revision=3, nodes={id: NodeSettings(**keys)})


def user_rule(**keys):
    return node("mission", rules={"own": RuleSettings(**keys)})


def checked(plan, settings):
    """Return the plan in force under settings, once it has passed the checks."""
    effective = EffectivePlan(plan, settings)
    check_settings(effective)
    return effective.plan


def test_what_fits_is_the_plan_in_force():
    after = checked(plan(), node("drive", policy=PolicyName.BLOCK))
    assert (after.grcn[0].policy, after.revision) == (PolicyName.BLOCK, 3)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        (node("drive", policy=PolicyName.SAFE), "Safe is not for a GRCN"),
        (node("drive", threshold=1.0), "no setting of drive is called threshold"),
        (node("drive", flows={"flow9": FlowSettings(block=True)}), "did you mean flow2?"),
        (node("drive", rules={"own": RuleSettings()}), "drive has no rules"),
        (node("drive", flows={"flow1": FlowSettings(priority=1)}), "the same priority 1"),
        (node("speed", policy=PolicyName.PREEMPTION), "Preemption is not for the RSRCN"),
        (node("mission", policy=PolicyName.SAFE), "Safe is not for the MSRCN"),
        (user_rule(when="night"), "a new one needs `when` and `block`"),
        (user_rule(block=("/goal",)), "a new one needs `when` and `block`"),
        (user_rule(when="nite", block=("/goal",)), "there is no eflow nite"),
        (user_rule(when="night &&", block=("/goal",)), "it ends too early"),
        (user_rule(when="event.x > 1.0", block=("/goal",)), "there is no eflow event"),
        (user_rule(when="night > 1", block=("/goal",)), "'>' is not expected"),
        (user_rule(when="size(night) == 1", block=("/goal",)), "there is no eflow size"),
        (user_rule(when="true", block=("/gaol",)), "no aflow or topic /gaol in the MSRCN"),
        (user_rule(when="(" * 40 + "night" + ")" * 40, block=("/goal",)), "nested deeper than 32"),
    ],
)
def test_what_makes_no_plan_is_refused(settings, told):
    with pytest.raises(InputError, match=re.escape(told)):
        checked(plan(), settings)


@pytest.mark.parametrize("when", ["night", "!night && (alone || night)", "true"])
def test_an_own_rule_combines_eflows(when):
    after = checked(plan(), user_rule(when=when, block=("aflow1",)))
    assert after.msrcn.rules[-1].when == when


def test_constrain_needs_a_limit():
    given = plan_with("  max_vel_limit: 0.5 m/s\n", "")
    with pytest.raises(InputError, match="Constrain needs a max_vel_limit"):
        checked(given, node("speed", policy=PolicyName.CONSTRAIN))
    checked(given, node("speed", policy=PolicyName.CONSTRAIN, max_vel_limit=0.1))


def test_a_plans_own_faults_are_not_held_against_settings():
    odd = plan().grcn[0]
    flawed = plan().__class__(app="odd", grcn=(odd, odd.__class__(**_fields(odd) | {"id": "two"})))
    assert checked(flawed, node("two", policy=PolicyName.BLOCK)).grcn[1].policy == "Block"
    with pytest.raises(InputError, match="Safe is not for a GRCN: choose"):
        checked(flawed, node("two", policy=PolicyName.SAFE))


def _fields(noun):
    return {name: getattr(noun, name) for name in noun.__dataclass_fields__}


OVERRIDE = TimedOverride(by="eve", reason="docking", until=5)


def test_under_the_same_plan_all_still_fits():
    settings = Settings(
        revision=3,
        nodes={
            "drive": NodeSettings(policy=PolicyName.BLOCK),
            "speed": NodeSettings(threshold=1.0),
        },
        overrides={"speed": OVERRIDE},
    )
    assert drop_misfits(plan(), settings) == (settings, ())


@pytest.mark.parametrize(
    ("old", "new", "settings", "told"),
    [
        ("id: drive", "id: wheels", node("drive", policy=PolicyName.BLOCK), "drive"),
        ("flow2", "flow3", node("drive", flows={"flow2": FlowSettings(block=True)}), "flow2"),
        (
            "priority: 1",
            "priority: 7",
            node("drive", flows={"flow1": FlowSettings(priority=7)}),
            "7",
        ),
        (
            "policy: Safe",
            "policy: Safe\n  mandatory: Safe",
            node("speed", policy=PolicyName.BLOCK),
            "mandatory",
        ),
        (
            "eflows:\n    - {name: night",
            "eflows:\n    - {name: dark",
            user_rule(when="night", block=("/goal",)),
            "night",
        ),
    ],
)
def test_under_another_plan_what_does_not_fit_is_left_out(old, new, settings, told):
    changed = PLAN.replace(old, new)
    if old.startswith("eflows"):
        changed = changed.replace("when: night", "when: dark")
    both = Settings(
        revision=3, nodes={**settings.nodes, **_other(settings)}, overrides={"speed": OVERRIDE}
    )
    left, lost = drop_misfits(plan(changed), both)
    assert left == Settings(revision=3, nodes=_other(settings), overrides={"speed": OVERRIDE})
    assert len(lost) == 1
    assert told in lost[0]


def _other(settings):
    if "speed" in settings.nodes:
        return {"drive": NodeSettings(policy=PolicyName.BLOCK)}
    return {"speed": NodeSettings(threshold=1.0)}
