"""What counts as a problem of a robot, at its bounds; the order of robots; what is taken back."""

from collections import Counter
from dataclasses import replace

import pytest

from rtron.service.domain.rollouts.decisions import spread_kinds
from rtron.service.domain.rollouts.observations import (
    MIN_MESSAGES,
    Observation,
    RobotBaseline,
    baseline_of,
    find_problems,
)
from rtron.service.domain.rollouts.plans import take_back
from rtron.service.domain.rollouts.schemas import Problem
from rtron.vocabulary import (
    Alarm,
    AlarmKind,
    FlowSettings,
    GuardState,
    Mode,
    NodeSettings,
    PolicyName,
    RuleSettings,
    StreamState,
    VerdictCounts,
)

ALARM = Alarm(kind=AlarmKind.DRIFT, reason="why", topic="/cmd_vel")


def state(passed=0, dropped=0, **values):
    flows = {"f": VerdictCounts(passed=passed, dropped=dropped)}
    stream = StreamState(topic="/t", nodes=("n",), mode=Mode.ENFORCE, flows=flows)
    return GuardState(at=0, revision=0, streams=(stream,), **values)


def problems(before, after, *, rise=0.1, now=1000, recent=frozenset(), **values):
    observation = Observation(state=after, **values)
    return find_problems(baseline_of(before, recent), observation, rise, 30, now)


def test_a_robot_that_is_as_before_shows_nothing():
    before = state(100, 50, alarms=(ALARM,), stopped=True)
    assert problems(before, state(200, 100, alarms=(ALARM,), stopped=True)) == set()
    assert find_problems(RobotBaseline(), Observation(state=None), 0.1, 30, 0) == set()


def test_a_new_alarm_and_no_other():
    assert problems(state(), state(alarms=(ALARM,))) == {Problem.ALARM}
    known = state(alarms=(ALARM,))
    assert problems(known, state(alarms=(replace(ALARM, reason="other words"),))) == set()
    assert problems(known, state(alarms=(replace(ALARM, topic="/other"),))) == {Problem.ALARM}
    assert problems(known, state()) == set()


def test_a_stop_that_was_not_in_force_before():
    assert problems(state(), state(stopped=True)) == {Problem.STOPPED}
    assert problems(state(stopped=True), state()) == set()


@pytest.mark.parametrize(
    ("before", "passed", "dropped", "is_blocked"),
    [
        ((0, 0), MIN_MESSAGES - 11, 10, False),
        ((0, 0), MIN_MESSAGES - 10, 10, True),
        ((0, 0), 90, 10, False),
        ((0, 0), 89, 11, True),
        ((50, 50), 40, 60, False),
        ((50, 50), 39, 61, True),
        ((50, 50), 100, 0, False),
        ((0, 100), 0, 100, False),
    ],
)
def test_the_share_of_blocked_messages_since_the_change(before, passed, dropped, is_blocked):
    after = state(before[0] + passed, before[1] + dropped)
    found = problems(state(*before), after)
    assert found == ({Problem.BLOCKED} if is_blocked else set())


def test_counts_that_began_anew_are_no_share():
    assert problems(state(1000, 0), state(0, 500)) == set()


@pytest.mark.parametrize(("dropped", "is_blocked"), [(10, False), (40, True)])
def test_counts_that_begin_anew_with_a_plan_are_a_share(dropped, is_blocked):
    before = replace(baseline_of(state(900, 100), frozenset()), is_counted_anew=True)
    after = Observation(state=state(100, dropped))
    found = find_problems(before, after, 0.1, 30, 1000)
    assert found == ({Problem.BLOCKED} if is_blocked else set())


@pytest.mark.parametrize(
    ("since", "is_gone"), [(None, False), (971, False), (970, True), (1, True)]
)
def test_a_guard_that_stays_away_is_gone(since, is_gone):
    assert (problems(state(), None, missing_since=since) == {Problem.GONE}) is is_gone


def test_what_a_robot_did_of_late_without_the_change_is_not_the_changes_doing():
    told = frozenset({Problem.ALARM, Problem.STOPPED, Problem.RESTARTED})
    assert problems(state(), state(), events=told) == told
    recent = frozenset({Problem.STOPPED})
    assert problems(state(), state(), events=told, recent=recent) == told - recent


def test_a_refusal_is_a_problem():
    assert problems(state(), state(), is_refused=True) == {Problem.REFUSED}


def test_early_stages_have_some_of_each_kind_of_robot():
    kinds = {f"r{index:04}": ("odd" if index % 33 == 5 else "even") for index in range(1000)}
    odd = Counter(kinds.values())["odd"]
    assert odd == 31
    for seed in range(50):
        order = spread_kinds(kinds, seed)
        assert sorted(order) == sorted(kinds)
        assert kinds[order[0]] == "even"
        assert 3 <= sum(kinds[robot] == "odd" for robot in order[:100]) <= 5


def test_one_robot_of_a_kind_of_its_own_comes_early():
    kinds = {f"r{index}": "many" for index in range(500)} | {"a": "one", "b": "other"}
    for seed in range(20):
        assert set(spread_kinds(kinds, seed)[:3]) >= {"a", "b"}


def test_the_order_is_of_the_seed():
    kinds = dict.fromkeys((f"r{index}" for index in range(50)), "same")
    assert spread_kinds(kinds, 3) == spread_kinds(dict(reversed(kinds.items())), 3)
    assert spread_kinds(kinds, 3) != spread_kinds(kinds, 4)


BEFORE = {"speed": NodeSettings(max_vel_limit=0.5), "drive": NodeSettings()}
CHANGED = {
    "speed": NodeSettings(max_vel_limit=0.3, policy=PolicyName.CONSTRAIN),
    "drive": NodeSettings(flows={"flow1": FlowSettings(priority=3, block=True)}),
}


def test_what_the_change_set_is_as_before():
    assert take_back(BEFORE, CHANGED, CHANGED) == {"speed": NodeSettings(max_vel_limit=0.5)}


def test_what_others_have_set_since_stays():
    current = {
        "speed": replace(CHANGED["speed"], max_vel_limit=0.2, threshold=0.01),
        "drive": NodeSettings(
            flows={
                "flow1": FlowSettings(priority=7, block=True, timeout=5),
                "flow2": FlowSettings(priority=1),
            }
        ),
        "mission": NodeSettings(rules={"night": RuleSettings(selected=False)}),
    }
    assert take_back(BEFORE, CHANGED, current) == {
        "speed": NodeSettings(max_vel_limit=0.2, threshold=0.01),
        "drive": NodeSettings(
            flows={"flow1": FlowSettings(priority=7, timeout=5), "flow2": FlowSettings(priority=1)}
        ),
        "mission": NodeSettings(rules={"night": RuleSettings(selected=False)}),
    }


def test_what_the_change_took_away_comes_back():
    before = {"mission": NodeSettings(rules={"own": RuleSettings(when="night", block=("/goal",))})}
    assert take_back(before, {}, {}) == before
    assert take_back(before, {}, CHANGED) == {**before, **CHANGED}


def test_a_change_that_never_arrived_leaves_all_as_it_is():
    assert take_back(BEFORE, CHANGED, BEFORE) == {"speed": NodeSettings(max_vel_limit=0.5)}
