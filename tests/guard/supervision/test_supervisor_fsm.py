"""What the supervisor does about the guard, decision by decision."""

import signal

import pytest

from rtron.guard.supervision.supervisor_fsm import (
    END_TIMEOUT,
    GUARD_EXISTS,
    HANG_TIMEOUT,
    LOST_TIMEOUT,
    OUT_OF_MEMORY,
    STALL_TIMEOUT,
    START_TIMEOUT,
    WARM_START_TIMEOUT,
    GuardObservation,
    GuardPhase,
    SupervisorAction,
    SupervisorFsm,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, Watchdog
from rtron.vocabulary import SECOND

KILLED = -signal.SIGKILL
WELL, ABSENT = GuardObservation(0, is_serving=True), GuardObservation(0, is_serving=False)


def silent(duration):
    return GuardObservation(duration, is_serving=True)


def serving(now=0):
    keeper = SupervisorFsm(now)
    assert keeper.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
    assert keeper.tick(now, WELL) == (SupervisorAction.RELEASE,)
    return keeper


def dead(keeper, now, code=KILLED):
    keeper.lost(now)
    return keeper.ended(now, code)


def test_a_guard_is_started_at_once_and_left_alone_while_it_is_well():
    keeper = SupervisorFsm(5)
    assert keeper.tick(5, ABSENT) == (SupervisorAction.SPAWN,)
    assert keeper.tick(6, ABSENT) == ()
    assert keeper.tick(7, WELL) == (SupervisorAction.RELEASE,)
    assert keeper.tick(8, WELL) == ()


def test_an_adopted_guard_is_not_started():
    keeper = SupervisorFsm(0, is_adopted=True)
    assert keeper.tick(0, WELL) == ()
    assert keeper.connection_lost(1) == (SupervisorAction.BRAKE,)


def test_silence_stops_the_robot_and_only_long_silence_kills():
    keeper = serving()
    assert keeper.tick(1, silent(STALL_TIMEOUT - 1)) == ()
    assert keeper.tick(2, silent(STALL_TIMEOUT)) == (SupervisorAction.BRAKE,)
    assert keeper.tick(3, silent(HANG_TIMEOUT - 1)) == ()
    assert keeper.tick(4, silent(HANG_TIMEOUT)) == (SupervisorAction.KILL,)
    assert keeper.tick(5, silent(2 * HANG_TIMEOUT)) == ()


def test_a_stall_ends_with_the_next_beat():
    keeper = serving()
    keeper.tick(1, silent(STALL_TIMEOUT))
    assert keeper.tick(2, WELL) == (SupervisorAction.RELEASE,)
    assert keeper.tick(3, silent(STALL_TIMEOUT)) == (SupervisorAction.BRAKE,)


def test_a_dead_guard_stops_the_robot_and_is_followed_by_another():
    keeper = serving()
    assert keeper.connection_lost(5 * SECOND) == (SupervisorAction.BRAKE,)
    assert keeper.connection_lost(5 * SECOND) == ()
    assert keeper.guard_ended(5 * SECOND, KILLED) == ()
    assert keeper.tick(5 * SECOND, ABSENT) == (SupervisorAction.SPAWN,)
    assert keeper.tick(6 * SECOND, WELL) == (SupervisorAction.RELEASE,)


def test_a_guard_that_never_served_has_moved_nothing():
    keeper = SupervisorFsm(0)
    keeper.tick(0, ABSENT)
    assert keeper.connection_lost(1) == ()


def test_a_guard_that_takes_too_long_to_start_is_killed():
    keeper = SupervisorFsm(0)
    keeper.tick(0, ABSENT)
    assert keeper.tick(START_TIMEOUT, ABSENT) == ()
    assert keeper.tick(START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)


def test_a_guard_that_was_ready_is_given_less_time_to_begin_than_the_next():
    keeper = SupervisorFsm(0)
    keeper.tick(0, ABSENT)
    keeper.spare_taken()
    assert keeper.tick(WARM_START_TIMEOUT, ABSENT) == ()
    assert keeper.tick(WARM_START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)
    dead(keeper, WARM_START_TIMEOUT + 1)
    began = keeper.restart_due
    assert keeper.tick(began, ABSENT) == (SupervisorAction.SPAWN,)
    assert keeper.tick(began + START_TIMEOUT, ABSENT) == ()
    assert keeper.tick(began + START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)


def test_a_guard_that_cannot_be_started_is_tried_again_later_and_later():
    keeper = serving()
    dead(keeper, 5 * SECOND)
    now, delays = keeper.restart_due, []
    for _ in range(8):
        assert keeper.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
        keeper.start_failed(now)
        delays.append(keeper.restart_due - now)
        assert keeper.tick(keeper.restart_due - 1, ABSENT) == ()
        now = keeper.restart_due
    assert delays == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40, 40)]


def test_nobody_waits_for_a_guard_that_could_not_be_started():
    keeper = SupervisorFsm(0)
    keeper.tick(0, ABSENT)
    keeper.start_failed(0)
    assert keeper.shut_down(1) == (SupervisorAction.LEAVE,)


def test_a_guard_that_dies_again_and_again_is_waited_for_ever_longer_but_not_given_up():
    keeper, now, delays = serving(), 0, []
    for _ in range(40):
        dead(keeper, now)
        delays.append(keeper.restart_due - now)
        assert keeper.tick(keeper.restart_due - 1, ABSENT) == ()
        now = keeper.restart_due
        assert keeper.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
        keeper.tick(now, WELL)
    assert delays[:7] == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40)]
    assert set(delays[6:]) == {10 * SECOND}


@pytest.mark.parametrize(("served", "delay"), [(2 * SECOND, 0), (2 * SECOND - 1, SECOND // 2)])
def test_a_guard_that_served_for_a_while_is_followed_at_once(served, delay):
    keeper = serving()
    dead(keeper, 0)
    keeper.tick(keeper.restart_due, ABSENT)
    began = keeper.restart_due
    keeper.tick(began, WELL)
    dead(keeper, began + served)
    assert keeper.restart_due - began - served == delay


def test_a_guard_that_is_lost_but_does_not_end_is_killed():
    keeper = serving()
    keeper.connection_lost(0)
    assert keeper.tick(LOST_TIMEOUT, silent(LOST_TIMEOUT)) == ()
    assert keeper.tick(LOST_TIMEOUT + 1, silent(LOST_TIMEOUT)) == (SupervisorAction.KILL,)
    assert keeper.tick(LOST_TIMEOUT + 2, silent(LOST_TIMEOUT)) == ()


def test_to_end_is_to_end_the_guard_first():
    keeper = serving()
    assert keeper.shut_down(1) == (SupervisorAction.TERMINATE,)
    assert keeper.shut_down(2) == ()
    assert keeper.connection_lost(3) == (SupervisorAction.BRAKE,)
    assert keeper.guard_ended(3, 0) == (SupervisorAction.LEAVE,)
    assert keeper.code == 0
    assert keeper.phase is GuardPhase.OVER


def test_a_guard_that_does_not_end_is_killed():
    keeper = serving()
    keeper.shut_down(0)
    assert keeper.tick(END_TIMEOUT, WELL) == ()
    assert keeper.tick(END_TIMEOUT + 1, WELL) == (SupervisorAction.KILL,)
    keeper.connection_lost(END_TIMEOUT + 1)
    assert keeper.guard_ended(END_TIMEOUT + 1, KILLED) == (SupervisorAction.LEAVE,)


def test_a_guard_that_ends_in_order_stops_the_robot_and_has_its_time():
    keeper = serving()
    assert keeper.tick(0, GuardObservation(0, is_serving=True, is_leaving=True)) == (
        SupervisorAction.BRAKE,
    )
    assert (
        keeper.tick(END_TIMEOUT, GuardObservation(END_TIMEOUT, is_serving=True, is_leaving=True))
        == ()
    )
    assert keeper.tick(
        END_TIMEOUT + 1, GuardObservation(END_TIMEOUT, is_serving=True, is_leaving=True)
    ) == (SupervisorAction.KILL,)


def test_a_guard_that_hangs_instead_of_ending_is_killed_at_once():
    keeper = serving()
    keeper.shut_down(0)
    assert keeper.tick(HANG_TIMEOUT, silent(HANG_TIMEOUT)) == (SupervisorAction.KILL,)


def test_nobody_waits_for_a_guard_that_is_not_there():
    keeper = serving()
    dead(keeper, 0)
    assert keeper.shut_down(1) == (SupervisorAction.LEAVE,)
    assert keeper.tick(keeper.restart_due, ABSENT) == ()


@pytest.mark.parametrize(
    ("code", "ends_with"),
    [(0, 0), (GUARD_EXISTS, 2), (KILLED, None), (OUT_OF_MEMORY, None), (2, None)],
)
def test_what_becomes_of_the_supervisor_when_the_guard_ends(code, ends_with):
    keeper = serving()
    acts = dead(keeper, 1, code)
    assert acts == (() if ends_with is None else (SupervisorAction.LEAVE,))
    assert ends_with is None or keeper.code == ends_with


def test_a_guard_that_is_refused_at_once_is_not_started_again():
    keeper = SupervisorFsm(0)
    keeper.tick(0, ABSENT)
    assert dead(keeper, 1, 2) == (SupervisorAction.LEAVE,)
    assert keeper.code == 2


def test_another_supervisor_is_left_the_guard():
    keeper = serving()
    assert keeper.hand_over() == (SupervisorAction.LEAVE,)
    assert keeper.connection_lost(1) == ()
    assert keeper.tick(2, silent(HANG_TIMEOUT)) == ()


def test_a_beat_that_stays_the_same_is_silence():
    watchdog = Watchdog(0)
    assert watchdog.update(BEAT_PERIOD, 7) == 0
    assert watchdog.update(2 * BEAT_PERIOD, 7) == BEAT_PERIOD
    assert watchdog.update(3 * BEAT_PERIOD, 7) == 2 * BEAT_PERIOD
    assert watchdog.update(4 * BEAT_PERIOD, 8) == 0


def test_time_in_which_nobody_looked_is_not_the_silence_of_the_other():
    watchdog = Watchdog(0)
    watchdog.update(BEAT_PERIOD, 7)
    assert watchdog.update(BEAT_PERIOD + 60 * SECOND, 7) < STALL_TIMEOUT
