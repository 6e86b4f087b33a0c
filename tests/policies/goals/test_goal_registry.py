import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.policies.goals.registry import (
    ID_REUSE_DELAY,
    MAX_FINISHED_GOALS,
    MAX_ID_LENGTH,
    MAX_UNOWNED_GOALS,
    Goal,
    GoalRegistry,
    GoalStage,
)

ONE, TWO = "/one", "/two"


def goals(*names, client=ONE):
    made = GoalRegistry()
    for name in names:
        made.add(goal(name, client))
    return made


def goal(id, client=ONE, stamp=0, **more):
    return Goal(id, stamp, "flow1", client, **more)


def ids(goals):
    return [goal.id for goal in goals]


def test_a_goal_is_known_until_it_is_over():
    made = goals(b"a", b"b")
    a = made.find(b"a")
    assert (a.id, a.stage, a.cancel_reason, a.status, a.message) == (
        b"a",
        GoalStage.WAITING,
        "",
        0,
        b"",
    )
    assert (len(made), ids(made)) == (2, [b"a", b"b"])
    made.finish(a, 0)
    assert (len(made), made.find(b"a"), made.is_finished(b"a"), made.is_finished(b"b")) == (
        1,
        None,
        True,
        False,
    )
    made.finish(a, 10**12)
    assert made.rejection_reason(b"a", ONE, ID_REUSE_DELAY) == ""


def test_goals_may_end_while_they_are_looked_at():
    made = goals(b"a", b"b")
    for each in made:
        made.finish(each, 0)
    assert len(made) == 0


@pytest.mark.parametrize(
    ("client", "at", "free"),
    [
        (ONE, 0, False),
        (ONE, ID_REUSE_DELAY - 1, False),
        (ONE, ID_REUSE_DELAY, True),
        (TWO, 10**12, False),
    ],
)
def test_an_id_is_free_again_for_its_client_after_a_while(client, at, free):
    made = goals(b"a")
    assert made.rejection_reason(b"a", client, at) == "another goal has this id"
    made.finish(made.find(b"a"), 0)
    assert made.rejection_reason(b"a", client, at) == (
        "" if free else "a goal that is over had this id"
    )


@pytest.mark.parametrize(
    ("length", "why"), [(MAX_ID_LENGTH, ""), (MAX_ID_LENGTH + 1, "a goal id of 1025")]
)
def test_ids_are_bounded(length, why):
    assert GoalRegistry().rejection_reason(b"x" * length, ONE, 0).startswith(why)
    assert bool(why) == bool(GoalRegistry().rejection_reason(b"x" * length, ONE, 0))


@pytest.mark.parametrize(("client", "free"), [("", False), (ONE, True)])
def test_goals_without_a_client_are_bounded(client, free):
    made = goals(*(b"%d" % n for n in range(MAX_UNOWNED_GOALS - 1)), client="")
    made.add(goal(b"own"))
    assert made.rejection_reason(b"last", client, 0) == ""
    made.add(goal(b"last", ""))
    full = f"{MAX_UNOWNED_GOALS} goals have no client"
    assert made.rejection_reason(b"more", client, 0) == ("" if free else full)


def test_what_is_remembered_is_bounded():
    made = GoalRegistry()
    for number in range(MAX_FINISHED_GOALS + 1):
        made.remember_finished(b"%d" % number, ONE, 0)
    assert [made.is_finished(b"%d" % n) for n in (0, 1, MAX_FINISHED_GOALS)] == [False, True, True]


def test_a_cancel_by_id_means_one_own_goal():
    made = goals(b"a", b"b")
    assert ids(made.cancel_targets(ONE, b"a", 0, 0)) == [b"a"]
    assert ids(made.cancel_targets(TWO, b"a", 0, 0)) == []
    assert ids(made.cancel_targets(ONE, b"c", 0, 0)) == []


def test_an_empty_cancel_means_all_own_goals():
    made = goals(b"a", b"b")
    made.add(goal(b"c", TWO))
    assert ids(made.cancel_targets(ONE, b"", 0, 0)) == [b"a", b"b"]
    assert ids(made.cancel_targets(TWO, b"", 0, 0)) == [b"c"]
    assert ids(made.cancel_targets("/three", b"", 0, 0)) == []


@pytest.mark.parametrize(("stamp", "meant"), [(4, []), (5, [b"b"]), (6, [b"b"]), (7, [b"b", b"c"])])
def test_a_cancel_with_a_stamp_means_what_is_older(stamp, meant):
    made = goals(b"a")
    made.add(goal(b"b", stamp=5))
    made.add(goal(b"c", stamp=7))
    assert ids(made.cancel_targets(ONE, b"", stamp, 0)) == meant
    assert ids(made.cancel_targets(ONE, b"a", stamp, 0)) == [b"a", *meant]


def test_a_goal_older_than_a_cancel_that_came_before_it_is_cancelled():
    made = GoalRegistry()
    made.cancel_targets(ONE, b"", 5, 0)
    made.cancel_targets(ONE, b"", 3, 0)
    assert made.was_cancelled_early(goal(b"a", stamp=5), 0)
    assert not made.was_cancelled_early(goal(b"b", stamp=6), 0)
    assert not made.was_cancelled_early(goal(b"c", stamp=0), 0)
    assert not made.was_cancelled_early(goal(b"d", TWO, stamp=5), 0)


@pytest.mark.parametrize(("at", "meant"), [(ID_REUSE_DELAY - 1, True), (ID_REUSE_DELAY, False)])
def test_a_cancel_may_come_before_its_goal(at, meant):
    made = GoalRegistry()
    made.cancel_targets(ONE, b"a", 0, 0)
    assert not made.was_cancelled_early(goal(b"a", TWO), 0)
    assert made.was_cancelled_early(goal(b"a"), at) is meant
    assert not made.was_cancelled_early(goal(b"a"), at)


def test_a_cancel_of_a_goal_that_is_there_is_none_of_one_to_come():
    made = goals(b"a")
    made.cancel_targets(ONE, b"a", 0, 0)
    assert not made.was_cancelled_early(goal(b"a"), 0)


def test_cancels_of_goals_to_come_are_bounded():
    made = GoalRegistry()
    for number in range(65):
        made.cancel_targets(ONE, b"%d" % number, 0, 0)
    assert not made.was_cancelled_early(goal(b"0"), 0)
    assert made.was_cancelled_early(goal(b"1"), 0)
    for number in range(257):
        made.cancel_targets(f"/client{number}", b"", 5, 0)
    assert not made.was_cancelled_early(goal(b"x", "/client0", stamp=1), 0)
    assert made.was_cancelled_early(goal(b"x", "/client1", stamp=1), 0)


names = st.binary(max_size=4)
owned = st.tuples(names, st.integers(0, 2**62), st.sampled_from([ONE, TWO, ""]), st.booleans())


@given(st.lists(owned, unique_by=lambda each: each[0]), st.lists(names, max_size=5))
def test_the_next_guard_knows_the_same(every, over):
    made = GoalRegistry()
    for id, stamp, client, sent in every:
        where = GoalStage.SENT if sent else GoalStage.WAITING
        made.add(goal(id, client, stamp, stage=where, message=b"kept by the policy"))
    for id in over:
        made.remember_finished(id, ONE, 0)
    again = GoalRegistry()
    again.restore(json.loads(json.dumps(made.snapshot())), 7)
    told = {(g.id, g.stamp, g.flow, g.client, g.stage) for g in made}
    assert {(g.id, g.stamp, g.flow, g.client, g.stage) for g in again} == told
    assert all(g.last_seen == 7 and not g.message for g in again)
    assert all(again.is_finished(id) for id in over)


def test_what_is_left_to_the_next_guard_is_bounded():
    made = GoalRegistry()
    for number in range(300):
        made.remember_finished(b"%d" % number, ONE, 0)
    again = GoalRegistry()
    again.restore(made.snapshot(), 0)
    assert [again.is_finished(b"%d" % n) for n in (43, 44, 299)] == [False, True, True]


@pytest.mark.parametrize("letter", [b"x", b"\xff"])
def test_long_ids_and_names_do_not_keep_others_from_being_known(letter):
    made, rogue = GoalRegistry(), "/" + "\u00e9" * 1000
    for number in range(600):
        made.add(goal(letter * 1020 + b"%d" % number, rogue))
        made.remember_finished(letter * 1020 + b"over%d" % number, rogue, 0)
    made.add(goal(b"waits"))
    made.add(goal(b"runs"))
    made.mark_sent(made.find(b"runs"), 0)
    made.remember_finished(b"done", ONE, 0)
    kept = made.snapshot()
    assert len(json.dumps(kept)) <= 1 << 17
    again = GoalRegistry()
    again.restore(kept, 0)
    assert [again.find(id).client for id in (b"waits", b"runs")] == [ONE, ONE]
    assert again.find(b"runs").stage is GoalStage.SENT
    assert again.is_finished(b"done")


@pytest.mark.parametrize(("length", "fits"), [(1024, True), (1025, False)])
def test_names_of_clients_are_bounded(length, fits):
    assert (GoalRegistry().rejection_reason(b"a", "x" * length, 0) == "") is fits


def test_the_goals_of_a_flow_that_wait_are_counted():
    made = goals(b"a", b"b", b"c")
    assert (made.waiting_count("flow1"), made.waiting_count("flow2")) == (3, 0)
    made.mark_sent(made.find(b"a"), 7)
    made.mark_sent(made.find(b"a"), 8)
    assert (made.waiting_count("flow1"), made.find(b"a").last_seen) == (2, 8)
    made.finish(made.find(b"a"), 0)
    made.finish(made.find(b"b"), 0)
    assert made.waiting_count("flow1") == 1


def test_stamps_never_go_back_also_with_the_next_guard():
    made = GoalRegistry()
    assert [made.monotonic_stamp(stamp) for stamp in (5, 3, 7, 0)] == [5, 5, 7, 7]
    again = GoalRegistry()
    again.restore(made.snapshot(), 0)
    assert again.monotonic_stamp(6) == 7
