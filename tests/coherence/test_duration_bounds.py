"""Durations: one table for plans, settings and the API; what it allows and is odd is a doubt."""

from contextlib import suppress
from dataclasses import replace

import pytest
from controller_setup import plan as service_plan
from plans import grcn, plan_of

from rtron.coherence import EffectivePlan, SettingsMismatchError, coherence_problems
from rtron.coherence.duration_bounds import (
    DURATION_RANGES,
    LONG_EVENT_AGE,
    LONG_SILENCE,
    LONGEST_SILENCE,
    duration_doubts,
)
from rtron.errors import InputError
from rtron.planning.plan_file.fields import plan_fields
from rtron.service.domain.settings_patch import merge_patch
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Audit,
    EventFlow,
    Flow,
    FlowSettings,
    GuardedTopic,
    Mode,
    NodeSettings,
    OnForeign,
    Plan,
    PolicyName,
    Settings,
    StreamKind,
    Supervision,
)
from rtron.vocabulary.plan import LONGEST_STALL

HOUR = 3600 * SECOND
GOALS = plan_of(grcn("/act/goal", ["/a"], ["/b"], kind=StreamKind.ACTION))
SETTABLE = [
    (key, DURATION_RANGES[key][bound] + step, inside)
    for key in ("release_after", "max_age", "max_hold", "timeout")
    for bound, step, inside in ((0, -1, False), (0, 0, True), (1, 0, True), (1, 1, False))
]


def settings_of(key, value):
    if key == "timeout":
        return NodeSettings(flows={"flow1": FlowSettings(timeout=value)})
    return NodeSettings(**{key: value})


def is_settable(key, value):
    """Tell whether a guard takes a setting for goals, which may last long."""
    node = settings_of(key, value)
    with suppress(SettingsMismatchError):
        return bool(EffectivePlan(GOALS, Settings(nodes={GOALS.grcn[0].id: node})).check())
    return False


def is_in_the_api(key, value):
    """Tell whether the service takes a setting."""
    node = {"flows": {"flow1": {key: value}}} if key == "timeout" else {key: value}
    with suppress(InputError):
        return bool(merge_patch(service_plan(), Settings(revision=4), {"drive": node}))
    return False


@pytest.mark.parametrize(("key", "value", "inside"), SETTABLE)
def test_plans_settings_and_the_api_have_the_same_bounds(key, value, inside):
    least, greatest = plan_fields(Flow if key == "timeout" else GRCN)[key].range
    assert (least <= value <= greatest) is inside
    assert is_settable(key, value) is inside
    assert is_in_the_api(key, value) is inside


def test_every_duration_of_a_plan_has_a_bound_that_people_can_mean():
    assert all(greatest <= 24 * HOUR for _, greatest in DURATION_RANGES.values())
    assert plan_fields(Flow)["silent_after"].range == (SECOND // 100, LONGEST_SILENCE)
    assert plan_fields(EventFlow)["max_age"].range == (SECOND // 100, 24 * HOUR)
    assert plan_fields(GRCN)["release_after"].range[0] > 0


def problems(**settings):
    plan = plan_of(grcn("/cmd_vel", ["/a"], ["/b"], **settings))
    return [message for _, _, message in coherence_problems(plan)]


def test_what_moves_the_robot_is_never_old():
    for key in ("release_after", "max_age"):
        for kind in StreamKind:
            told = problems(kind=kind, **{key: LONGEST_SILENCE + 1})
            assert bool(told) is (kind is StreamKind.COMMAND)
        assert problems(kind=StreamKind.COMMAND, **{key: LONGEST_SILENCE}) == []
    flows = (Flow(name="flow1", publisher="/a", timeout=HOUR),)
    assert problems(kind=StreamKind.COMMAND, flows=flows) == [
        "timeout is 3600 s: for commands 10 s at most"
    ]


def doubts(plan):
    return [f"{where}: {message}" for where, message in duration_doubts(plan)]


@pytest.mark.parametrize("key", ["release_after", "max_age"])
def test_long_waits_of_commands_are_doubted(key):
    def plan(value, **more):
        return plan_of(grcn("/t", ["/a"], [], policy=PolicyName.PREEMPTION, **{key: value}, **more))

    assert doubts(plan(LONG_SILENCE)) == []
    (doubt,) = doubts(plan(LONG_SILENCE + SECOND))
    assert doubt.startswith(f"GRCN grcn_t: {key} is 3 s: ")
    assert doubts(plan(9 * SECOND, kind=StreamKind.ACTION)) == []
    assert doubts(plan(9 * SECOND, mode=Mode.OBSERVE)) == []


def test_flows_that_are_long_silent_are_doubted_wherever_they_are():
    flows = (
        Flow(name="usual", publisher="/a", silent_after=LONG_SILENCE, timeout=LONG_SILENCE),
        Flow(name="flow9", publisher="/b", silent_after=3 * SECOND, timeout=3 * SECOND),
    )
    topic = GuardedTopic(topic="/t", type="geometry_msgs/Twist", flows=flows)
    found = doubts(
        Plan(
            app="x",
            grcn=(grcn("/t", (), [], flows=flows),),
            rsrcn=RSRCN(id="rsrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, vflows=(topic,)),
            msrcn=MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(topic,)),
        )
    )
    silent = "silent_after is 3 s: so long the robot goes on without a command"
    waiting = "so long nobody else drives when this flow falls silent"
    assert found == [
        f"GRCN grcn_t: flow9: timeout is 3 s: {waiting}",
        f"GRCN grcn_t, flow9: {silent}",
        f"RSRCN, flow9: {silent}",
        f"MSRCN, flow9: {silent}",
    ]


def test_events_of_long_ago_are_doubted():
    def found(**settings):
        event = EventFlow(name="low", topic="/battery", publisher="/base", **settings)
        msrcn = MSRCN(id="m", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, eflows=(event,))
        return doubts(Plan(app="x", msrcn=msrcn))

    long = LONG_EVENT_AGE + SECOND
    assert found(when="event.data", max_age=LONG_EVENT_AGE) == []
    (doubt,) = found(when="event.data", max_age=long)
    assert doubt.startswith("MSRCN, low: max_age is 61 s")
    assert found(present=long, max_age=long) == []
    assert found(silent=LONG_EVENT_AGE) == []
    (doubt,) = found(silent=long)
    assert doubt.startswith("MSRCN, low: silent is 61 s")


def test_settings_are_not_blamed_for_what_the_plan_has():
    old = plan_of(grcn("/cmd_vel", ["/a"], ["/b"], max_age=HOUR))
    changed = Settings(revision=2, nodes={old.grcn[0].id: NodeSettings(release_after=SECOND)})
    assert EffectivePlan(old, changed).check() == replace(
        old, grcn=(replace(old.grcn[0], release_after=SECOND),), revision=2
    )


def test_a_stall_of_over_a_tenth_of_a_second_is_a_doubt():
    assert doubts(Plan(app="x", supervision=Supervision(stall_after=LONGEST_STALL))) == []
    (doubt,) = doubts(Plan(app="x", supervision=Supervision(stall_after=2 * LONGEST_STALL)))
    text = "supervision: stall_after is 0.2 s: so long the robot goes on without a guard"
    assert doubt == text


def test_a_short_absence_of_the_audit_is_a_doubt_where_a_crash_takes_longer():
    def plan(seconds, ros=2, on_foreign=OnForeign.STOP):
        supervision = Supervision(audit_within=seconds * SECOND)
        return Plan(app="x", ros=ros, audit=Audit(on_foreign=on_foreign), supervision=supervision)

    assert doubts(plan(8)) == []
    assert doubts(plan(7)) == [
        "supervision: audit_within is 7 s: a crash of the bulk process may stop the robot"
    ]
    assert doubts(plan(7, ros=1)) == []
    assert doubts(plan(7, on_foreign=OnForeign.ALARM)) == []
