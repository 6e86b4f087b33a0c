from hypothesis import given
from hypothesis import strategies as st
from service_app import SECOND, ManualClock

from rtron.service.domain.clock import SteadyClock

HOUR = 3600 * SECOND


def steady_clock():
    wall, monotonic = ManualClock(), ManualClock()
    monotonic.now = 5 * SECOND
    return wall, monotonic, SteadyClock(wall, monotonic)


def test_it_is_the_wall_clock_while_nobody_sets_that():
    wall, monotonic, steady = steady_clock()
    for _ in range(3):
        wall.sleep(1)
        monotonic.sleep(1)
        assert steady() == wall.now


def test_it_goes_on_where_the_wall_clock_is_set_back():
    wall, monotonic, steady = steady_clock()
    begin = wall.now
    wall.now -= 2 * HOUR
    monotonic.sleep(7)
    assert steady() == begin + 7 * SECOND
    wall.sleep(1)
    monotonic.sleep(1)
    assert steady() == begin + 8 * SECOND


def test_it_follows_a_wall_clock_that_is_set_forward():
    wall, _, steady = steady_clock()
    wall.now += 40 * HOUR
    assert steady() == wall.now


@given(st.lists(st.tuples(st.integers(-(10**15), 10**15), st.integers(0, 10**12))))
def test_it_never_goes_back_nor_slower_than_time_does(steps):
    wall, monotonic, steady = steady_clock()
    before = steady()
    for step, passed in steps:
        wall.now += step
        monotonic.now += passed
        now = steady()
        assert now >= before + passed
        before = now
