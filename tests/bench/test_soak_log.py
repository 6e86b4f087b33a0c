"""What the soak finds wrong in what a base heard, and what it does not blame the guard for."""

from dataclasses import replace

import pytest

from bench.soak.base_log import LONGEST_GAP, BaseLog, Command, Gap
from bench.soak.node import FORBIDDEN, INTRUDING, SPEED
from rtron.vocabulary import SECOND

PERIOD = SECOND // 20
LATE = 2 * LONGEST_GAP


def commands(speed, begin, end, period=PERIOD):
    return [Command(at, speed) for at in range(begin, end, period)]


def log_with_gap(last_speed, inputs_period=PERIOD):
    """Return a base that hears nothing for `LATE` after one second."""
    outputs = [
        *commands(SPEED, 0, SECOND),
        Command(SECOND, last_speed),
        *commands(SPEED, SECOND + LATE, 2 * SECOND),
    ]
    return BaseLog(commands(SPEED, 0, 2 * SECOND, inputs_period), outputs)


def test_a_base_that_hears_all_in_time_has_no_gap():
    log = BaseLog(commands(SPEED, 0, SECOND), commands(SPEED, 5, SECOND))
    assert log.unexplained_gaps() == []
    assert log.longest_gap() == PERIOD
    assert log.unguarded() == []
    assert log.share(SPEED) == 1


@pytest.mark.parametrize("speed", [SPEED, 0.1])
def test_a_base_that_moves_and_hears_nothing_has_a_gap(speed):
    (gap,) = log_with_gap(speed).unexplained_gaps()
    assert (gap.at, gap.length) == (SECOND, LATE)
    assert log_with_gap(speed).longest_gap() == LATE


@pytest.mark.parametrize("speed", [0.0, INTRUDING])
def test_a_base_at_rest_and_one_that_an_intruder_drives_wait_for_nobody(speed):
    assert log_with_gap(speed).unexplained_gaps() == []


def test_a_gap_of_the_navigation_is_not_the_guards():
    assert log_with_gap(SPEED, inputs_period=LATE).unexplained_gaps() == []


@pytest.mark.parametrize(
    ("begin", "length", "left"),
    [(0, LATE, LATE), (-LATE, LATE, LATE), (-PERIOD, 4 * LATE, 0), (PERIOD, PERIOD, LATE - PERIOD)],
)
def test_the_time_in_which_the_base_did_not_run_is_not_the_guards(begin, length, left):
    log = log_with_gap(SPEED)
    stall = Gap(SECOND + begin if begin else 2 * SECOND, length)
    stalled = replace(log, stalls=[stall])
    assert [each.length for each in stalled.unexplained_gaps()] == [left] * (left > LONGEST_GAP)


def test_a_gap_is_described_by_what_was_said_in_it_and_what_came_after():
    log = log_with_gap(SPEED)
    (gap,) = log.unexplained_gaps()
    assert log.describe(gap) == "the navigation said 3 in it, 1 came within 20 ms after it"


def test_silence_to_the_end_is_a_gap():
    log = BaseLog(commands(SPEED, 0, 2 * SECOND), commands(SPEED, 0, SECOND))
    (gap,) = log.unexplained_gaps()
    assert gap.length >= SECOND - PERIOD


def test_what_nobody_planned_is_found():
    log = BaseLog([], [Command(1, SPEED), Command(2, FORBIDDEN), Command(3, INTRUDING)])
    assert log.unguarded() == [Command(2, FORBIDDEN)]


def test_a_file_is_read_up_to_its_last_whole_line(tmp_path):
    path = tmp_path / "base.txt"
    path.write_text("in 1 0.5\nin 2 9\nstall 2 0.5\nout 3 0.5\nout 4 0\nout 5 0.")
    log = BaseLog.read(path)
    assert log.inputs == [Command(1, 0.5)]
    assert log.outputs == [Command(3, 0.5), Command(4, 0.0)]
    assert log.stalls == [Gap(2, SECOND // 2)]
    assert log.longest_rest() == 0
