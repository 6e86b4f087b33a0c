"""Stops that are late, rough, or easily missed; the usual one is none of it."""

import pytest

from rtron.planning.plan_doubts import stop_doubts, void_value_warnings
from rtron.vocabulary import RSRCN, SECOND, Mode, Plan, PolicyName, StopProfile

MS = SECOND // 1000
ZEROS = "a base that misses what says 0 drives on; raise `repeat` (1 s)"
STEPS = "the robot brakes in steps that long; 50 ms is usual"
LATE = "raise `decel`, or lower `within`"
STOPS = [
    ({}, []),
    ({"period": 100 * MS}, []),
    ({"period": 101 * MS}, [f"period is 0.101 s: {STEPS}"]),
    ({"period": 500 * MS, "repeat": 3 * SECOND // 2}, [f"period is 0.5 s: {STEPS}"]),
    ({"repeat": 101 * MS}, []),
    ({"repeat": 100 * MS}, [f"a stop ends with 2 messages of velocity 0: {ZEROS}"]),
    ({"repeat": 0}, [f"a stop ends with one message of velocity 0: {ZEROS}"]),
    ({"decel": 0.5, "within": 10 * SECOND}, []),
    (
        {"decel": 0.4, "within": 10 * SECOND},
        [f"a stop takes 2.5 s, and from 1 m/s the robot drives 1.2 m on: {LATE}"],
    ),
    ({"decel": 0.01, "within": 2 * SECOND}, []),
    ({"angular_decel": 0.5, "within": 3 * SECOND}, []),
    (
        {"angular_decel": 0.4, "within": 10 * SECOND},
        ["a stop takes 2.5 s to end a turn of 1 rad/s: raise `angular_decel`, or lower `within`"],
    ),
    (
        {"decel": 0.01, "angular_decel": 0.01, "within": 10 * SECOND},
        [f"a stop takes 10 s, and from 1 m/s the robot drives 5 m on: {LATE}"],
    ),
]


@pytest.mark.parametrize(("stop", "doubts"), STOPS)
def test_what_follows_from_a_stop(stop, doubts):
    assert list(stop_doubts(Plan(app="a", stop=StopProfile(**stop)))) == doubts


def test_a_stop_from_a_low_limit_is_short():
    slow = RSRCN(id="r", mode=Mode.ENFORCE, policy=PolicyName.CONSTRAIN, max_vel_limit=0.2)
    stop = StopProfile(decel=0.1, within=10 * SECOND)
    assert not list(stop_doubts(Plan(app="a", stop=stop, rsrcn=slow)))


def test_the_doubts_are_warnings_of_a_check():
    plan = Plan(app="a", stop=StopProfile(repeat=0))
    told = [str(each) for each in void_value_warnings(plan)]
    assert any(each.startswith("warning: stop: a stop ends with one message") for each in told)
