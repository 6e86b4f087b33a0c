"""Whose messages come late, by clocks that need not agree."""

import pytest

from rtron.guard.transport.ros2.delivery import LatenessDetector
from rtron.vocabulary import SECOND

MS = SECOND // 1000
BOUND = 250 * MS
ONE, OTHER = b"one", b"other"
CLOCKS = [0, 3600 * SECOND, -3600 * SECOND]


class ManualClock:
    """Gives messages of a certain delay to a `LatenessDetector`; our clock is `skew` ahead."""

    def __init__(self, skew=0):
        self.lateness = LatenessDetector()
        self.skew = skew
        self.now = 10**18
        self.steady = 0

    def late(self, took, publisher=ONE, said=None):
        said = self.now - took - self.skew if said is None else said
        return self.lateness.is_late(publisher, said, self.now, lambda: self.steady)

    def go_on(self, duration):
        self.now += duration
        self.steady += duration


@pytest.mark.parametrize("skew", CLOCKS)
@pytest.mark.parametrize(("over", "late"), [(BOUND, False), (BOUND + 1, True)])
def test_what_took_longer_than_usual_is_late(skew, over, late):
    watch = ManualClock(skew)
    assert not watch.late(MS)
    assert watch.late(MS + over) is late


def test_the_quickest_is_the_measure_although_the_first_was_slow():
    watch = ManualClock()
    assert [watch.late(took) for took in (SECOND, MS, MS + BOUND + 1)] == [False, False, True]


def test_after_a_stall_all_that_waited_is_late_and_the_next_is_not():
    watch = ManualClock()
    watch.late(MS)
    assert all(watch.late(took) for took in range(800 * MS, BOUND + MS, -20 * MS))
    assert not watch.late(MS)


def test_each_publisher_has_its_own_clock():
    watch = ManualClock()
    watch.late(MS)
    assert not watch.late(10 * SECOND, OTHER)
    assert watch.late(10 * SECOND)
    assert not watch.late(10 * SECOND, OTHER)


@pytest.mark.parametrize("jump", [SECOND, 3600 * SECOND])
def test_a_clock_that_was_set_makes_late_for_a_second_only(jump):
    watch = ManualClock()
    watch.late(MS)
    watch.skew += jump
    assert watch.late(MS)
    watch.go_on(SECOND - 1)
    assert watch.late(MS)
    watch.go_on(1)
    assert not watch.late(MS)
    assert watch.late(MS + BOUND + 1)


def test_a_clock_that_was_set_the_other_way_makes_nothing_late():
    watch = ManualClock()
    watch.late(MS)
    watch.skew -= 3600 * SECOND
    assert not watch.late(MS)
    assert watch.late(MS + BOUND + 1)


def test_two_stalls_are_no_clock_that_was_set():
    watch = ManualClock()
    watch.late(MS)
    assert watch.late(SECOND)
    watch.go_on(SECOND)
    assert not watch.late(MS)
    assert watch.late(SECOND)


def test_a_clock_that_runs_slow_is_followed():
    watch = ManualClock()
    for _ in range(100_000):
        watch.skew += 10_000
        assert not watch.late(MS)


def test_where_nobody_tells_when_it_was_said_nothing_is_late():
    watch = ManualClock()
    watch.late(MS)
    assert not watch.late(0, said=0)
    assert watch.late(MS + BOUND + 1)


def test_a_crowd_makes_it_forget_but_no_bigger():
    watch = ManualClock()
    for number in range(1000):
        watch.late(MS, number.to_bytes(16, "big"))
    assert len(watch.lateness._typical_delays) <= 256
