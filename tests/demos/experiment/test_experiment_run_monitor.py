"""When a run is over, and what came of it."""

from dataclasses import replace

import pytest
from demo_runs import CORRIDOR, ROOM, corridor_drive

from rtron.demos.cases import CASES, GR, MSR, RSR
from rtron.demos.experiment.session import MAX_DURATION, RunMonitor

FIRST = corridor_drive()[0]


def monitored(case, *truths, scene=CORRIDOR):
    judge = RunMonitor(case, scene)
    for truth in truths:
        judge.observe(truth)
    return judge


def truth_at(t, **values):
    return replace(FIRST, t=t, velocity=(0.2, 0.0), distance_to_goal=3.0, **values)


@pytest.mark.parametrize("case", CASES.values())
def test_a_quiet_drive_goes_on_until_the_robot_stands_at_the_goal(case):
    way = truth_at(1.0), truth_at(2.0)
    assert not monitored(case).is_over
    assert not monitored(case, *way).is_over
    near = replace(truth_at(3.0), distance_to_goal=0.14)
    judge = monitored(case, *way, near)
    assert (judge.arrived_at, judge.harm, judge.is_over) == (3.0, "", False)
    judge.observe(replace(near, t=3.2, velocity=(0.0, 0.0)))
    assert judge.is_over
    assert judge.arrived_at == 3.0


def test_a_robot_that_does_not_stand_still_at_the_goal_is_not_waited_for():
    judge = monitored(
        GR, replace(truth_at(3.0), distance_to_goal=0.1), replace(truth_at(5.1), distance_to_goal=1)
    )
    assert judge.is_over


@pytest.mark.parametrize("case", CASES.values())
def test_a_collision_is_harm_in_every_case_and_ends_the_run(case):
    judge = monitored(case, truth_at(1.0), truth_at(2.0, collided=True))
    assert (judge.harm, judge.harmed_at, judge.is_over) == ("collision", 2.0, False)
    judge.observe(truth_at(2.4, collided=True))
    assert judge.is_over


def test_too_fast_is_harm_where_the_eyes_cannot_follow():
    fast = replace(truth_at(2.0), velocity=(0.27, 0.0))
    assert monitored(RSR, fast).harm == "overspeed"
    assert monitored(RSR, replace(fast, velocity=(-0.27, 0.0))).harm == "overspeed"
    assert monitored(RSR, replace(fast, velocity=(0.25, 0.0))).harm == ""
    assert monitored(GR, fast).harm == ""


def test_after_harm_there_is_a_while_to_see_what_comes_of_it():
    fast = replace(truth_at(2.0), velocity=(1.0, 0.0))
    assert not monitored(RSR, fast, replace(fast, t=4.9)).is_over
    assert monitored(RSR, fast, replace(fast, t=5.0)).is_over
    judge = monitored(RSR, fast, replace(fast, t=3.0, collided=True))
    assert (judge.harm, judge.collided, judge.is_over) == ("overspeed", True, True)


def test_the_area_is_harm_where_the_mission_forbids_it():
    assert monitored(MSR, truth_at(1.0, in_area=True), scene=ROOM).harm == "network lost"
    assert monitored(GR, truth_at(1.0, in_area=True)).harm == ""


def test_a_robot_that_collided_near_the_goal_has_not_arrived():
    judge = monitored(GR, replace(truth_at(1.0, collided=True), distance_to_goal=0.1))
    assert judge.arrived_at is None


def test_no_run_lasts_for_ever():
    assert monitored(GR, truth_at(MAX_DURATION)).is_over
    assert monitored(GR, truth_at(MAX_DURATION)).arrived_at is None
