"""What the supervisor does about the guard, decision by decision."""

import signal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.guard.supervision.supervisor_fsm import (
    END_TIMEOUT,
    LOST_TIMEOUT,
    OUT_OF_MEMORY,
    USELESS_AFTER,
    WARM_START_TIMEOUT,
    GuardObservation,
    GuardPhase,
    SupervisorAction,
    SupervisorFsm,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, SchedulingDelay, Watchdog, adapt_bound
from rtron.vocabulary import SECOND, Supervision
from rtron.vocabulary.plan import LONGEST_STALL

KILLED = -signal.SIGKILL
BOUNDS = Supervision()
STALL_TIMEOUT, GUARD_HANG_TIMEOUT = BOUNDS.stall_after, BOUNDS.kill_after
START_TIMEOUT = BOUNDS.start_within
WELL, ABSENT = GuardObservation(0, is_serving=True), GuardObservation(0, is_serving=False)


def silent(duration, delay=0):
    return GuardObservation(duration, is_serving=True, delay=delay)


def stuck(duration, delay=0):
    return GuardObservation(0, is_serving=True, delay=delay, undelivered=duration)


def serving(now=0, bounds=BOUNDS):
    fsm = SupervisorFsm(now, bounds)
    assert fsm.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
    assert fsm.tick(now, WELL) == (SupervisorAction.RELEASE,)
    return fsm


def dead(fsm, now, code=KILLED):
    fsm.connection_lost(now)
    return fsm.guard_ended(now, code)


def test_a_guard_is_started_at_once_and_left_alone_while_it_is_well():
    fsm = SupervisorFsm(5, BOUNDS)
    assert fsm.tick(5, ABSENT) == (SupervisorAction.SPAWN,)
    assert fsm.tick(6, ABSENT) == ()
    assert fsm.tick(7, WELL) == (SupervisorAction.RELEASE,)
    assert fsm.tick(8, WELL) == ()


def test_silence_stops_the_robot_and_only_long_silence_kills():
    fsm = serving()
    assert fsm.tick(1, silent(STALL_TIMEOUT - 1)) == ()
    assert fsm.tick(2, silent(STALL_TIMEOUT)) == (SupervisorAction.BRAKE,)
    assert fsm.tick(3, silent(GUARD_HANG_TIMEOUT - 1)) == ()
    assert fsm.tick(4, silent(GUARD_HANG_TIMEOUT)) == (SupervisorAction.KILL,)
    assert fsm.tick(5, silent(2 * GUARD_HANG_TIMEOUT)) == ()


def test_a_stall_ends_with_the_next_beat():
    fsm = serving()
    fsm.tick(1, silent(STALL_TIMEOUT))
    assert fsm.tick(2, WELL) == (SupervisorAction.RELEASE,)
    assert fsm.tick(3, silent(STALL_TIMEOUT)) == (SupervisorAction.BRAKE,)


def test_a_dead_guard_stops_the_robot_and_is_followed_by_another():
    fsm = serving()
    assert fsm.connection_lost(5 * SECOND) == (SupervisorAction.BRAKE,)
    assert fsm.connection_lost(5 * SECOND) == ()
    assert fsm.guard_ended(5 * SECOND, KILLED) == ()
    assert fsm.tick(5 * SECOND, ABSENT) == (SupervisorAction.SPAWN,)
    assert fsm.tick(6 * SECOND, WELL) == (SupervisorAction.RELEASE,)


def test_a_guard_that_never_served_has_moved_nothing():
    fsm = SupervisorFsm(0, BOUNDS)
    fsm.tick(0, ABSENT)
    assert fsm.connection_lost(1) == ()


def test_a_guard_that_takes_too_long_to_start_is_killed():
    fsm = SupervisorFsm(0, BOUNDS)
    fsm.tick(0, ABSENT)
    assert fsm.tick(START_TIMEOUT, ABSENT) == ()
    assert fsm.tick(START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)


def test_a_guard_that_was_ready_is_given_less_time_to_begin_than_the_next():
    fsm = SupervisorFsm(0, BOUNDS)
    fsm.tick(0, ABSENT)
    fsm.spare_taken()
    assert fsm.tick(WARM_START_TIMEOUT, ABSENT) == ()
    assert fsm.tick(WARM_START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)
    dead(fsm, WARM_START_TIMEOUT + 1)
    began = fsm.restart_due
    assert fsm.tick(began, ABSENT) == (SupervisorAction.SPAWN,)
    assert fsm.tick(began + START_TIMEOUT, ABSENT) == ()
    assert fsm.tick(began + START_TIMEOUT + 1, ABSENT) == (SupervisorAction.KILL,)


def test_a_guard_that_cannot_be_started_is_tried_again_later_and_later():
    fsm = serving()
    dead(fsm, 5 * SECOND)
    now, delays = fsm.restart_due, []
    for _ in range(8):
        assert fsm.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
        fsm.start_failed(now)
        delays.append(fsm.restart_due - now)
        assert fsm.tick(fsm.restart_due - 1, ABSENT) == ()
        now = fsm.restart_due
    assert delays == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40, 40)]


def test_nobody_waits_for_a_guard_that_could_not_be_started():
    fsm = SupervisorFsm(0, BOUNDS)
    fsm.tick(0, ABSENT)
    fsm.start_failed(0)
    assert fsm.shut_down(1) == (SupervisorAction.LEAVE,)


def test_a_guard_that_dies_again_and_again_is_waited_for_ever_longer_but_not_given_up():
    fsm, now, delays = serving(), 0, []
    for _ in range(40):
        dead(fsm, now)
        delays.append(fsm.restart_due - now)
        assert fsm.tick(fsm.restart_due - 1, ABSENT) == ()
        now = fsm.restart_due
        assert fsm.tick(now, ABSENT) == (SupervisorAction.SPAWN,)
        fsm.tick(now, WELL)
    assert delays[:7] == [SECOND * n // 4 for n in (1, 2, 4, 8, 16, 32, 40)]
    assert set(delays[6:]) == {10 * SECOND}


@pytest.mark.parametrize(("served", "delay"), [(2 * SECOND, 0), (2 * SECOND - 1, SECOND // 2)])
def test_a_guard_that_served_for_a_while_is_followed_at_once(served, delay):
    fsm = serving()
    dead(fsm, 0)
    fsm.tick(fsm.restart_due, ABSENT)
    began = fsm.restart_due
    fsm.tick(began, WELL)
    dead(fsm, began + served)
    assert fsm.restart_due - began - served == delay


def test_a_guard_that_is_lost_but_does_not_end_is_killed():
    fsm = serving()
    fsm.connection_lost(0)
    assert fsm.tick(LOST_TIMEOUT, silent(LOST_TIMEOUT)) == ()
    assert fsm.tick(LOST_TIMEOUT + 1, silent(LOST_TIMEOUT)) == (SupervisorAction.KILL,)
    assert fsm.tick(LOST_TIMEOUT + 2, silent(LOST_TIMEOUT)) == ()


def test_to_end_is_to_end_the_guard_first():
    fsm = serving()
    assert fsm.shut_down(1) == (SupervisorAction.TERMINATE,)
    assert fsm.shut_down(2) == ()
    assert fsm.connection_lost(3) == (SupervisorAction.BRAKE,)
    assert fsm.guard_ended(3, 0) == (SupervisorAction.LEAVE,)
    assert fsm.code == 0
    assert fsm.phase is GuardPhase.ENDED


def test_a_guard_that_does_not_end_is_killed():
    fsm = serving()
    fsm.shut_down(0)
    assert fsm.tick(END_TIMEOUT, WELL) == ()
    assert fsm.tick(END_TIMEOUT + 1, WELL) == (SupervisorAction.KILL,)
    fsm.connection_lost(END_TIMEOUT + 1)
    assert fsm.guard_ended(END_TIMEOUT + 1, KILLED) == (SupervisorAction.LEAVE,)


def test_a_guard_that_ends_in_order_stops_the_robot_and_has_its_time():
    fsm = serving()
    assert fsm.tick(0, GuardObservation(0, is_serving=True, is_leaving=True)) == (
        SupervisorAction.BRAKE,
    )
    assert (
        fsm.tick(END_TIMEOUT, GuardObservation(END_TIMEOUT, is_serving=True, is_leaving=True)) == ()
    )
    assert fsm.tick(
        END_TIMEOUT + 1, GuardObservation(END_TIMEOUT, is_serving=True, is_leaving=True)
    ) == (SupervisorAction.KILL,)


def test_a_guard_that_hangs_instead_of_ending_is_killed_at_once():
    fsm = serving()
    fsm.shut_down(0)
    assert fsm.tick(GUARD_HANG_TIMEOUT, silent(GUARD_HANG_TIMEOUT)) == (SupervisorAction.KILL,)


def test_nobody_waits_for_a_guard_that_is_not_there():
    fsm = serving()
    dead(fsm, 0)
    assert fsm.shut_down(1) == (SupervisorAction.LEAVE,)
    assert fsm.tick(fsm.restart_due, ABSENT) == ()


def test_the_supervisor_ends_with_a_guard_that_ends_in_order():
    fsm = serving()
    assert dead(fsm, 1, 0) == (SupervisorAction.LEAVE,)
    assert fsm.code == 0


@pytest.mark.parametrize("code", [KILLED, OUT_OF_MEMORY, 2])
def test_a_guard_that_has_guarded_and_fails_is_followed_by_another(code):
    assert dead(serving(), 1, code) == ()


def test_a_guard_that_is_refused_at_once_is_not_started_again():
    fsm = SupervisorFsm(0, BOUNDS)
    fsm.tick(0, ABSENT)
    assert dead(fsm, 1, 2) == (SupervisorAction.LEAVE,)
    assert fsm.code == 2


def test_a_guard_that_beats_and_does_not_deliver_is_stopped_and_not_killed():
    fsm = serving()
    bound = BOUNDS.deliver_within
    assert fsm.tick(1, stuck(bound - 1)) == ()
    assert fsm.tick(2, stuck(bound)) == (SupervisorAction.BRAKE,)
    assert fsm.is_undelivered
    assert fsm.tick(3, stuck(USELESS_AFTER * bound - 1)) == ()
    assert fsm.tick(4, WELL) == (SupervisorAction.RELEASE,)
    assert not fsm.is_undelivered


@pytest.mark.parametrize("late", [0, SECOND // 100])
def test_a_guard_that_delivers_nothing_for_long_is_killed_for_the_next_one(late):
    fsm = serving()
    bound = USELESS_AFTER * (BOUNDS.deliver_within + 3 * late)
    assert fsm.tick(1, stuck(bound - 1, late)) == (SupervisorAction.BRAKE,)
    assert fsm.tick(2, stuck(bound, late)) == (SupervisorAction.KILL,)
    assert fsm.is_undelivered
    dead(fsm, 3)
    assert fsm.tick(fsm.restart_due, ABSENT) == (SupervisorAction.SPAWN,)


def test_delivery_may_be_later_on_a_busy_machine():
    fsm = serving()
    late = SECOND // 10
    assert fsm.tick(1, stuck(BOUNDS.deliver_within + 3 * late - 1, late)) == ()
    assert fsm.tick(2, stuck(BOUNDS.deliver_within + 3 * late, late)) == (SupervisorAction.BRAKE,)


def test_delivery_is_never_later_than_twice_its_bound():
    fsm = serving()
    very_late = 10 * SECOND
    assert fsm.tick(1, stuck(2 * BOUNDS.deliver_within - 1, very_late)) == ()
    assert fsm.tick(2, stuck(2 * BOUNDS.deliver_within, very_late)) == (SupervisorAction.BRAKE,)


def test_a_guard_that_stands_still_is_not_blamed_for_its_delivery():
    fsm = serving()
    silence = GuardObservation(STALL_TIMEOUT, is_serving=True, undelivered=SECOND)
    assert fsm.tick(1, silence) == (SupervisorAction.BRAKE,)
    assert not fsm.is_undelivered


def test_the_next_guard_is_not_blamed_for_what_the_last_one_did_not_deliver():
    fsm = serving()
    fsm.tick(1, stuck(SECOND))
    dead(fsm, 2)
    assert not fsm.is_undelivered


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


@given(st.integers(BEAT_PERIOD, SECOND))
def test_a_look_that_is_late_is_no_stall_by_itself(since):
    watchdog, delay = Watchdog(0), SchedulingDelay(0)
    watchdog.update(BEAT_PERIOD, 7)
    delay.update(BEAT_PERIOD)
    now = BEAT_PERIOD + since
    fsm = serving(bounds=Supervision(stall_after=2 * BEAT_PERIOD))
    assert fsm.tick(now, silent(watchdog.update(now, 7), delay.update(now))) == ()


def test_the_bounds_are_those_of_the_plan():
    stall, kill, start = SECOND // 20, 2 * SECOND, 5 * SECOND
    bounds = Supervision(stall_after=stall, kill_after=kill, start_within=start)
    fsm = serving(bounds=bounds)
    assert fsm.tick(1, silent(stall - 1)) == ()
    assert fsm.tick(2, silent(stall)) == (SupervisorAction.BRAKE,)
    assert fsm.tick(3, silent(kill - 1)) == ()
    assert fsm.tick(4, silent(kill)) == (SupervisorAction.KILL,)
    fsm = SupervisorFsm(0, bounds)
    fsm.tick(0, ABSENT)
    assert fsm.tick(start, ABSENT) == ()
    assert fsm.tick(start + 1, ABSENT) == (SupervisorAction.KILL,)


def test_a_guard_is_as_late_as_the_machine_and_no_later_than_the_longest_stall():
    late = 20 * SECOND // 1000
    explained = 3 * late + 2 * BEAT_PERIOD
    fsm = serving()
    assert fsm.tick(1, silent(explained - 1, late)) == ()
    assert fsm.tick(2, silent(explained, late)) == (SupervisorAction.BRAKE,)
    fsm = serving()
    assert fsm.tick(1, silent(LONGEST_STALL - 1, SECOND)) == ()
    assert fsm.tick(2, silent(LONGEST_STALL, SECOND)) == (SupervisorAction.BRAKE,)


def time_of_brake(frozen_at, first_look):
    """Return when the robot is stopped after a guard that beats on time until it freezes, ns."""
    watchdog, delay, fsm = Watchdog(0), SchedulingDelay(first_look - BEAT_PERIOD), serving()
    for now in range(first_look, SECOND, BEAT_PERIOD):
        beat = 1 + min(now, frozen_at) // BEAT_PERIOD
        silence = watchdog.update(now, beat)
        if fsm.tick(now, silent(silence, delay.update(now))) == (SupervisorAction.BRAKE,):
            return now
    raise AssertionError("the robot is not stopped")


@given(st.integers(0, SECOND // 20 - 1), st.integers(1, BEAT_PERIOD))
def test_a_base_that_hears_20_commands_a_second_is_stopped_with_time_to_spare(frozen, look):
    """A command came at 0, and the next one, due after 50 ms, is not sent: the base should wait
    100 ms at most.
    """
    assert time_of_brake(frozen, look) <= SECOND // 10 - 2 * BEAT_PERIOD


def test_a_plan_may_allow_a_longer_stall():
    longer = 2 * LONGEST_STALL
    fsm = serving(bounds=Supervision(stall_after=longer))
    assert fsm.tick(1, silent(longer - 1, SECOND)) == ()
    assert fsm.tick(2, silent(longer)) == (SupervisorAction.BRAKE,)


def test_the_worst_delay_is_known_for_a_second_and_forgotten_after_two():
    delay, now = SchedulingDelay(0), BEAT_PERIOD
    assert delay.update(now) == 0
    now += BEAT_PERIOD + 7
    assert delay.update(now) == 7
    seen = []
    for _ in range(2 * SECOND // BEAT_PERIOD + 1):
        now += BEAT_PERIOD
        seen.append(delay.update(now))
    assert set(seen[: SECOND // BEAT_PERIOD]) == {7}
    assert seen[-1] == 0


def test_a_tick_that_comes_early_is_not_late():
    assert SchedulingDelay(0).update(1) == 0


def test_the_lateness_of_slower_ticks_is_what_they_are_late_by():
    delay = SchedulingDelay(0, 5 * BEAT_PERIOD)
    assert delay.update(5 * BEAT_PERIOD) == 0
    assert delay.update(12 * BEAT_PERIOD) == 2 * BEAT_PERIOD


def test_a_bound_grows_with_the_lateness_up_to_the_longest():
    usual = 2 * BEAT_PERIOD
    assert adapt_bound(SECOND, 0, 5 * SECOND) == SECOND
    assert adapt_bound(SECOND, SECOND // 3, 5 * SECOND) == 3 * (SECOND // 3) + usual
    assert adapt_bound(SECOND, 4 * SECOND, 5 * SECOND) == 5 * SECOND
    assert adapt_bound(SECOND, 4 * SECOND, 0) == SECOND
