"""The clock of the simulated world."""

import pytest

from rtron.demos.world.robot_base import STEP
from rtron.demos.world.server import StepClock


class Wall:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


def steps(clock):
    count = 0
    while clock.is_due():
        count += 1
    return count


def test_steps_come_at_the_speed_and_do_not_drift():
    wall = Wall()
    clock = StepClock(2.0, STEP, wall)
    count = 0
    for _ in range(3000):
        wall.now += 0.01 / 3
        count += steps(clock)
    assert count == pytest.approx(10.0 * 2.0 / STEP, abs=1)
    assert clock.lost_time == 0.0


def test_a_clock_tells_how_long_to_wait_and_what_has_passed_of_a_step():
    wall = Wall()
    clock = StepClock(2.0, STEP, wall)
    assert clock.wait() == pytest.approx(0.025)
    wall.now += 0.020
    assert clock.wait() == pytest.approx(0.005)
    assert clock.step_fraction() == pytest.approx(0.8)
    wall.now += 0.020
    assert (clock.wait(), clock.step_fraction()) == (0.0, 1.0)


def test_a_clock_catches_up_a_little_and_lets_time_go_slower_if_it_is_far_behind():
    wall = Wall()
    clock = StepClock(1.0, STEP, wall)
    wall.now += 0.3
    assert steps(clock) == pytest.approx(6, abs=1)
    wall.now += 60.0
    assert steps(clock) == 1
    assert clock.lost_time == pytest.approx(60.0, abs=0.1)
