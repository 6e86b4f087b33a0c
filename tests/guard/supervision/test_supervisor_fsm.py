"""What the supervisor does about the guard, decision by decision."""

import signal

import pytest

from rtron.guard.supervision.supervisor_fsm import (
    BEGINNING,
    ENDING,
    HUNG,
    LOST,
    STALLED,
    STARTING,
    STARVED,
    TAKEN,
    Act,
    Keeper,
    Phase,
    Sign,
)
from rtron.guard.supervision.watchdog import LOOK, Watchdog
from rtron.vocabulary import SECOND

KILLED = -signal.SIGKILL
WELL, ABSENT = Sign(0, serving=True), Sign(0, serving=False)


def silent(duration):
    return Sign(duration, serving=True)


def serving(now=0):
    keeper = Keeper(now)
    assert keeper.look(now, ABSENT) == (Act.SPAWN,)
    assert keeper.look(now, WELL) == (Act.LOOSEN,)
    return keeper


def dead(keeper, now, code=KILLED):
    keeper.lost(now)
    return keeper.ended(now, code)


def test_a_guard_is_started_at_once_and_left_alone_while_it_is_well():
    keeper = Keeper(5)
    assert keeper.look(5, ABSENT) == (Act.SPAWN,)
    assert keeper.look(6, ABSENT) == ()
    assert keeper.look(7, WELL) == (Act.LOOSEN,)
    assert keeper.look(8, WELL) == ()


def test_an_adopted_guard_is_not_started():
    keeper = Keeper(0, adopted=True)
    assert keeper.look(0, WELL) == ()
    assert keeper.lost(1) == (Act.BRAKE,)


def test_silence_stops_the_robot_and_only_long_silence_kills():
    keeper = serving()
    assert keeper.look(1, silent(STALLED - 1)) == ()
    assert keeper.look(2, silent(STALLED)) == (Act.BRAKE,)
    assert keeper.look(3, silent(HUNG - 1)) == ()
    assert keeper.look(4, silent(HUNG)) == (Act.KILL,)
    assert keeper.look(5, silent(2 * HUNG)) == ()


def test_a_stall_ends_with_the_next_beat():
    keeper = serving()
    keeper.look(1, silent(STALLED))
    assert keeper.look(2, WELL) == (Act.LOOSEN,)
    assert keeper.look(3, silent(STALLED)) == (Act.BRAKE,)


def test_a_dead_guard_stops_the_robot_and_is_followed_by_another():
    keeper = serving()
    assert keeper.lost(5 * SECOND) == (Act.BRAKE,)
    assert keeper.lost(5 * SECOND) == ()
    assert keeper.ended(5 * SECOND, KILLED) == ()
    assert keeper.look(5 * SECOND, ABSENT) == (Act.SPAWN,)
    assert keeper.look(6 * SECOND, WELL) == (Act.LOOSEN,)


def test_a_guard_that_never_served_has_moved_nothing():
    keeper = Keeper(0)
    keeper.look(0, ABSENT)
    assert keeper.lost(1) == ()


def test_a_guard_that_takes_too_long_to_start_is_killed():
    keeper = Keeper(0)
    keeper.look(0, ABSENT)
    assert keeper.look(STARTING, ABSENT) == ()
    assert keeper.look(STARTING + 1, ABSENT) == (Act.KILL,)


def test_a_guard_that_was_ready_is_given_less_time_to_begin_than_the_next():
    keeper = Keeper(0)
    keeper.look(0, ABSENT)
    keeper.ready()
    assert keeper.look(BEGINNING, ABSENT) == ()
    assert keeper.look(BEGINNING + 1, ABSENT) == (Act.KILL,)
    dead(keeper, BEGINNING + 1)
    began = keeper.due
    assert keeper.look(began, ABSENT) == (Act.SPAWN,)
    assert keeper.look(began + STARTING, ABSENT) == ()
    assert keeper.look(began + STARTING + 1, ABSENT) == (Act.KILL,)


def test_a_guard_that_cannot_be_started_is_tried_again_later_and_later():
    keeper = serving()
    dead(keeper, 5 * SECOND)
    now, delays = keeper.due, []
    for _ in range(8):
        assert keeper.look(now, ABSENT) == (Act.SPAWN,)
        keeper.failed(now)
        delays.append(keeper.due - now)
        assert keeper.look(keeper.due - 1, ABSENT) == ()
        now = keeper.due
    assert delays == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40, 40)]


def test_nobody_waits_for_a_guard_that_could_not_be_started():
    keeper = Keeper(0)
    keeper.look(0, ABSENT)
    keeper.failed(0)
    assert keeper.end(1) == (Act.LEAVE,)


def test_a_guard_that_dies_again_and_again_is_waited_for_ever_longer_but_not_given_up():
    keeper, now, delays = serving(), 0, []
    for _ in range(40):
        dead(keeper, now)
        delays.append(keeper.due - now)
        assert keeper.look(keeper.due - 1, ABSENT) == ()
        now = keeper.due
        assert keeper.look(now, ABSENT) == (Act.SPAWN,)
        keeper.look(now, WELL)
    assert delays[:7] == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40)]
    assert set(delays[6:]) == {10 * SECOND}


@pytest.mark.parametrize(("served", "delay"), [(2 * SECOND, 0), (2 * SECOND - 1, SECOND // 2)])
def test_a_guard_that_served_for_a_while_is_followed_at_once(served, delay):
    keeper = serving()
    dead(keeper, 0)
    keeper.look(keeper.due, ABSENT)
    began = keeper.due
    keeper.look(began, WELL)
    dead(keeper, began + served)
    assert keeper.due - began - served == delay


def test_a_guard_that_is_lost_but_does_not_end_is_killed():
    keeper = serving()
    keeper.lost(0)
    assert keeper.look(LOST, silent(LOST)) == ()
    assert keeper.look(LOST + 1, silent(LOST)) == (Act.KILL,)
    assert keeper.look(LOST + 2, silent(LOST)) == ()


def test_to_end_is_to_end_the_guard_first():
    keeper = serving()
    assert keeper.end(1) == (Act.TERMINATE,)
    assert keeper.end(2) == ()
    assert keeper.lost(3) == (Act.BRAKE,)
    assert keeper.ended(3, 0) == (Act.LEAVE,)
    assert keeper.code == 0
    assert keeper.phase is Phase.OVER


def test_a_guard_that_does_not_end_is_killed():
    keeper = serving()
    keeper.end(0)
    assert keeper.look(ENDING, WELL) == ()
    assert keeper.look(ENDING + 1, WELL) == (Act.KILL,)
    keeper.lost(ENDING + 1)
    assert keeper.ended(ENDING + 1, KILLED) == (Act.LEAVE,)


def test_a_guard_that_ends_in_order_stops_the_robot_and_has_its_time():
    keeper = serving()
    assert keeper.look(0, Sign(0, serving=True, leaving=True)) == (Act.BRAKE,)
    assert keeper.look(ENDING, Sign(ENDING, serving=True, leaving=True)) == ()
    assert keeper.look(ENDING + 1, Sign(ENDING, serving=True, leaving=True)) == (Act.KILL,)


def test_a_guard_that_hangs_instead_of_ending_is_killed_at_once():
    keeper = serving()
    keeper.end(0)
    assert keeper.look(HUNG, silent(HUNG)) == (Act.KILL,)


def test_nobody_waits_for_a_guard_that_is_not_there():
    keeper = serving()
    dead(keeper, 0)
    assert keeper.end(1) == (Act.LEAVE,)
    assert keeper.look(keeper.due, ABSENT) == ()


@pytest.mark.parametrize(
    ("code", "ends_with"), [(0, 0), (TAKEN, 2), (KILLED, None), (STARVED, None), (2, None)]
)
def test_what_becomes_of_the_supervisor_when_the_guard_ends(code, ends_with):
    keeper = serving()
    acts = dead(keeper, 1, code)
    assert acts == (() if ends_with is None else (Act.LEAVE,))
    assert ends_with is None or keeper.code == ends_with


def test_a_guard_that_is_refused_at_once_is_not_started_again():
    keeper = Keeper(0)
    keeper.look(0, ABSENT)
    assert dead(keeper, 1, 2) == (Act.LEAVE,)
    assert keeper.code == 2


def test_another_supervisor_is_left_the_guard():
    keeper = serving()
    assert keeper.dismiss() == (Act.LEAVE,)
    assert keeper.lost(1) == ()
    assert keeper.look(2, silent(HUNG)) == ()


def test_a_beat_that_stays_the_same_is_silence():
    watchdog = Watchdog(0)
    assert watchdog.look(LOOK, 7) == 0
    assert watchdog.look(2 * LOOK, 7) == LOOK
    assert watchdog.look(3 * LOOK, 7) == 2 * LOOK
    assert watchdog.look(4 * LOOK, 8) == 0


def test_time_in_which_nobody_looked_is_not_the_silence_of_the_other():
    watchdog = Watchdog(0)
    watchdog.look(LOOK, 7)
    assert watchdog.look(LOOK + 60 * SECOND, 7) < STALLED
