"""What the soak finds wrong in what a base heard, and what it does not blame the guard for."""

from dataclasses import replace

import pytest

from bench.soak.base_log import LONGEST_GAP, BaseLog, Command, Span
from bench.soak.names import SIDE, SPEED, TURN
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
    assert log.longest_rest() == PERIOD


@pytest.mark.parametrize("speed", [SPEED, 0.1])
def test_a_base_that_moves_and_hears_nothing_has_a_gap(speed):
    (gap,) = log_with_gap(speed).unexplained_gaps()
    assert (gap.at, gap.length) == (SECOND, LATE)
    assert log_with_gap(speed).longest_gap() == LATE


def test_a_base_at_rest_waits_for_nobody():
    assert log_with_gap(0.0).unexplained_gaps() == []


def test_a_base_that_an_intruder_drives_waits_for_nobody():
    log = log_with_gap(SPEED)
    intruders = [replace(each, turn=-TURN) for each in log.outputs if each.at == SECOND]
    others = [each for each in log.outputs if each.at != SECOND]
    outputs = sorted([*others, *intruders], key=lambda each: each.at)
    assert replace(log, outputs=outputs).unexplained_gaps() == []


def test_a_gap_of_the_navigation_is_not_the_guards():
    assert log_with_gap(SPEED, inputs_period=LATE).unexplained_gaps() == []


@pytest.mark.parametrize(
    ("begin", "length", "left"),
    [(0, LATE, LATE), (-LATE, LATE, LATE), (-PERIOD, 4 * LATE, 0), (PERIOD, PERIOD, LATE - PERIOD)],
)
def test_the_time_in_which_the_base_did_not_run_is_not_the_guards(begin, length, left):
    log = log_with_gap(SPEED)
    stall = Span(SECOND + begin if begin else 2 * SECOND, length)
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


STRANGERS, INTRUDERS = Command(2, SPEED, turn=TURN), Command(3, SPEED, turn=-TURN)


def test_what_nobody_planned_is_found():
    log = BaseLog([], [Command(1, SPEED), STRANGERS, INTRUDERS])
    assert log.unguarded() == [STRANGERS]
    assert log.guarded() == [Command(1, SPEED), STRANGERS]


def test_a_rest_counts_without_what_explains_it():
    log = BaseLog([], [Command(0, SPEED), Command(1, 0.0), Command(5 * SECOND, SPEED)])
    assert log.longest_rest() == 5 * SECOND
    assert log.longest_rest([Span(SECOND, SECOND), Span(4 * SECOND, 9 * SECOND)]) == 3 * SECOND


def test_a_rest_to_the_end_counts():
    stopped = [*commands(SPEED, 0, SECOND), Command(SECOND, 0.0)]
    log = BaseLog(commands(SPEED, 0, 20 * SECOND + 1), stopped)
    assert log.unexplained_gaps() == []
    assert log.longest_rest() == 19 * SECOND + PERIOD
    assert log.longest_rest([Span(18 * SECOND, 9 * SECOND)]) == 17 * SECOND + PERIOD
    assert replace(log, inputs=[]).longest_rest() == PERIOD


def test_commands_that_move_have_a_share_of_those_of_the_guard():
    outputs = [Command(0, SPEED), Command(1, 0.0), Command(2, 0.0), Command(3, 0.0), INTRUDERS]
    assert BaseLog([], outputs).moving_share() == 0.25
    assert BaseLog([], []).moving_share() == 0


def intrusion(*outputs):
    """Return a log in which an intruder speaks from 1 s to 3 s, with `outputs` between."""
    words = [replace(INTRUDERS, at=SECOND), *outputs, replace(INTRUDERS, at=3 * SECOND)]
    return BaseLog([], [Command(0, SPEED), *words, Command(4 * SECOND, 0.0)])


def test_an_intruder_has_the_time_from_each_of_its_words_to_the_next_of_others():
    log = intrusion(Command(SECOND * 3 // 2, 0.0))
    assert log.intruder_share([Span(0, 3 * SECOND)]) == 0.25
    assert log.time_to_stop(Span(0, 3 * SECOND)) == SECOND // 2


def test_an_intruder_whom_nobody_stops_has_all_the_time():
    log = intrusion()
    assert log.intruder_share([Span(0, 3 * SECOND)]) == 1
    assert log.time_to_stop(Span(0, 3 * SECOND)) == 2 * SECOND


def test_an_intruder_after_whom_the_base_never_rests_was_never_stopped():
    words = [replace(INTRUDERS, at=at) for at in (SECOND, 3 * SECOND // 2)]
    log = BaseLog([], [Command(0, SPEED), *words, Command(9 * SECOND, SPEED)])
    assert log.time_to_stop(Span(0, 2 * SECOND)) == 8 * SECOND


def test_an_intruder_who_was_not_heard_has_none():
    log = intrusion()
    assert log.intruder_share([Span(5 * SECOND, SECOND)]) == 0
    assert log.time_to_stop(Span(5 * SECOND, SECOND)) == 0


def test_a_lower_flow_is_out_of_turn_only_while_the_higher_one_speaks():
    inputs = commands(SPEED, 0, 2 * SECOND)
    outputs = [Command(at, SPEED, SIDE) for at in range(0, 4 * SECOND, PERIOD)]
    assert BaseLog([], outputs).longest_turn_of_lower_flow() == 0
    longest = BaseLog(inputs, outputs).longest_turn_of_lower_flow()
    assert SECOND < longest < SECOND * 3 // 2


def test_a_file_is_read_up_to_its_last_whole_line(tmp_path):
    path = tmp_path / "base.txt"
    path.write_text("in 1 0.5 0 0\nstall 2 0.5 0 0\nout 3 0.5 0.5 1\nout 4 0 0 0\nout 5 0.")
    log = BaseLog.read(path)
    assert log.inputs == [Command(1, 0.5)]
    assert log.outputs == [Command(3, 0.5, 0.5, 1.0), Command(4, 0.0)]
    assert log.stalls == [Span(2, SECOND // 2)]
    assert BaseLog.read(path, last=24).outputs == [Command(4, 0.0)]
