import pytest

from rtron.messages.ros1 import actions
from rtron.policies.goals.registry import Goal, GoalRegistry, GoalStage
from rtron.policies.goals.status_list import (
    LOST_TIMEOUT,
    TERMINAL_STATUSES,
    UNREAD_TIMEOUT,
    add_discovered_goal,
    compare_status_list,
    lost_goals,
)
from rtron.vocabulary import SERVER_FLOW

PENDING, ACTIVE, SUCCEEDED = 0, 1, 3


def goals(*goals):
    made = GoalRegistry()
    for goal in goals:
        made.add(goal)
    return made


def sent(id, seen=0):
    return Goal(id, 0, "flow1", "/one", stage=GoalStage.SENT, last_seen=seen)


def ids(expected):
    return [goal.id for goal in expected]


@pytest.mark.parametrize("name", ["PENDING", "ACTIVE", "PREEMPTING", "RECALLING"])
def test_which_states_are_not_the_end(name):
    assert getattr(actions, name) not in TERMINAL_STATUSES
    assert len(TERMINAL_STATUSES) == 6


def test_what_is_listed_is_seen():
    a = sent(b"a")
    news = compare_status_list(goals(a), {b"a": ACTIVE}, 7)
    assert (a.last_seen, a.status, news.discovered, news.finished, news.resurrected) == (
        7,
        ACTIVE,
        [],
        [],
        [],
    )


def test_what_is_not_listed_is_not_seen():
    a = sent(b"a", seen=3)
    compare_status_list(goals(a), {}, 7)
    assert (a.last_seen, a.status) == (3, PENDING)


def test_what_is_over_is_told_as_long_as_it_is_there():
    a = sent(b"a")
    made = goals(a)
    for now in (7, 8):
        news = compare_status_list(made, {b"a": SUCCEEDED}, now)
        assert (ids(news.finished), a.last_seen, a.status) == ([b"a"], 7, SUCCEEDED)


@pytest.mark.parametrize(
    ("status", "expected"), [(PENDING, [b"x"]), (ACTIVE, [b"x"]), (SUCCEEDED, [])]
)
def test_unknown_goals_that_go_on_are_found(status, expected):
    made = GoalRegistry()
    news = compare_status_list(made, {b"x": status}, 7)
    assert ids(news.discovered) == expected
    for goal in news.discovered:
        assert (goal.flow, goal.client, goal.stage, goal.last_seen) == (
            SERVER_FLOW,
            "",
            GoalStage.SENT,
            7,
        )
        assert goal.status == status
    assert compare_status_list(made, {b"x": status}, 8).discovered == []


@pytest.mark.parametrize(("status", "astray"), [(ACTIVE, [b"a"]), (SUCCEEDED, [])])
def test_goals_that_were_answered_and_go_on_are_astray(status, astray):
    made = goals(sent(b"a"))
    made.finish(made.find(b"a"), 0)
    news = compare_status_list(made, {b"a": status}, 10**12)
    assert (news.resurrected, news.discovered) == (astray, [])


def test_ids_that_are_too_long_are_not_found():
    assert compare_status_list(GoalRegistry(), {b"x" * 1025: ACTIVE}, 0).discovered == []


@pytest.mark.parametrize(("late", "gone"), [(-1, []), (0, [b"a"])])
def test_goals_are_lost_after_a_while(late, gone):
    waiting = Goal(b"w", 0, "flow1", "/one")
    made = goals(sent(b"a", seen=5), waiting, sent(b"b", seen=6))
    assert ids(lost_goals(made, 5 + LOST_TIMEOUT + late)) == gone


@pytest.mark.parametrize(("late", "gone"), [(-1, []), (0, [b"a"])])
def test_a_goal_that_was_never_listed_is_lost_later(late, gone):
    made = goals(Goal(b"a", 0, "flow1", "/one"))
    made.mark_sent(made.find(b"a"), 5)
    assert ids(lost_goals(made, 5 + UNREAD_TIMEOUT + late)) == gone


def test_a_goal_that_was_listed_once_is_lost_as_soon_as_any():
    made = goals(Goal(b"a", 0, "flow1", "/one"))
    made.mark_sent(made.find(b"a"), 5)
    compare_status_list(made, {b"a": ACTIVE}, 7)
    assert ids(lost_goals(made, 7 + LOST_TIMEOUT)) == [b"a"]


def test_what_a_server_had_not_read_is_lost_with_it():
    made = goals(Goal(b"a", 0, "flow1", "/one"))
    made.mark_sent(made.find(b"a"), 5)
    made.forget_unread()
    assert ids(lost_goals(made, 5 + LOST_TIMEOUT)) == [b"a"]


def test_a_found_goal_keeps_its_stamp():
    made = GoalRegistry()
    assert add_discovered_goal(made, b"x", 3, stamp=9) is made.find(b"x")
    assert made.find(b"x").stamp == 9
