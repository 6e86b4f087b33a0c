"""Whoever makes the guard log cannot fill the disk, and nothing is left out in silence."""

import logging

import pytest

from rtron.guard.log_format import BURST, LogLimit


class Log:
    """What a log with a clock of the test's own has written."""

    def __init__(self):
        self.now, self.lines = 0.0, []
        self._limit = LogLimit(lambda: self.now)

    def say(self, text="refused", place=1):
        record = logging.LogRecord("x", logging.INFO, "a.py", place, "%s", (text,), None)
        if self._limit.filter(record):
            self.lines.append(record.getMessage())


@pytest.fixture
def log():
    return Log()


def test_a_burst_is_written_and_its_last_line_says_that_more_may_come(log):
    for _ in range(BURST - 1):
        log.say()
    assert log.lines == ["refused"] * (BURST - 1)
    log.say()
    assert log.lines[-1] == "refused (if more such lines come, one a second is written)"


def test_a_flood_gets_one_line_a_second_which_counts_the_others(log):
    for tenth in range(10 * 60):
        log.now = tenth / 10
        for _ in range(100):
            log.say()
    assert BURST + 58 <= len(log.lines) <= BURST + 60
    written = [line for line in log.lines if "(after" in line]
    omitted = sum(int(line.split("(after ")[1].split()[0]) for line in written)
    assert 60_000 - 2 * 1000 < omitted + len(log.lines) <= 60_000
    assert all("left out" in line for line in written)


def test_places_do_not_share_their_bound(log):
    for _ in range(2 * BURST):
        log.say()
    log.say("the guard stands still", place=2)
    assert log.lines[-1] == "the guard stands still"


def test_a_quiet_place_may_write_a_whole_burst_again(log):
    for _ in range(2 * BURST):
        log.say()
    log.now = float(BURST) - 0.5
    count = len(log.lines)
    for _ in range(2 * BURST):
        log.say()
    assert len(log.lines) - count == BURST - 1
    assert log.lines[count].startswith(f"refused (after {BURST} such lines that were left out)")


def test_less_than_a_second_gives_no_line(log):
    for _ in range(BURST):
        log.say()
    log.now = 0.99
    log.say()
    assert len(log.lines) == BURST
    log.now = 1.0
    log.say()
    assert len(log.lines) == BURST + 1
