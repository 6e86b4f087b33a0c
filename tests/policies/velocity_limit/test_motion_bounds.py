"""Turning, driving sideways and accelerating: each has a limit beside the linear one."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from limit_runs import alike, near
from policy_runs import LOW, often, settings

from rtron.policies import build_policy
from rtron.policies.state_transfer import PolicyState
from rtron.policies.velocity_limit.motion_bounds import AccelerationLimit, MotionBounds
from rtron.vocabulary import SECOND, Decision, Flow, PolicyName, Velocity

FLOW = (Flow(name=LOW, publisher="/low"),)
TURN, SIDE, ACCEL, STEP = 1.5, 0.1, 0.5, SECOND // 20


def constraining(**limits):
    return build_policy(
        settings(PolicyName.CONSTRAIN, flows=FLOW, **{"max_vel_limit": 1.0, **limits})
    )


def twist(*six):
    return Velocity(tuple(six[:3]), tuple(six[3:]))


@pytest.mark.parametrize("turn", [sign * each for each in near(TURN) for sign in (1, -1)])
@pytest.mark.parametrize("axis", [3, 4, 5])
def test_a_turn_at_the_bound_passes_and_the_next_number_does_not(axis, turn):
    asked = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0]
    asked[axis] = turn
    verdict = constraining(max_turn_limit=TURN).verdict(LOW, twist(*asked), 0)
    assert (verdict.decision is Decision.PASS) is (abs(turn) <= TURN)
    assert verdict.decision is Decision.PASS or verdict.message.angular_speed <= TURN


@pytest.mark.parametrize("side", [sign * each for each in near(SIDE) for sign in (1, -1)])
def test_sideways_at_the_bound_passes_and_the_next_number_does_not(side):
    verdict = constraining(max_side_limit=SIDE).verdict(LOW, twist(0.5, side, 0, 0, 0, 0), 0)
    assert (verdict.decision is Decision.PASS) is (abs(side) <= SIDE)
    assert verdict.decision is Decision.PASS or verdict.message.side_speed <= SIDE


def test_what_has_no_sideways_has_no_limit_there():
    policy = constraining(max_side_limit=0.0, max_turn_limit=0.0)
    assert policy.verdict(LOW, Velocity((0.5,)), 0).decision is Decision.PASS


def test_a_limit_of_0_stops_what_turns():
    verdict = constraining(max_turn_limit=0.0).verdict(LOW, twist(0.5, 0, 0, 0, 0, 0.1), 0)
    assert not verdict.message.is_moving


components = st.sampled_from([0.0, SIDE, TURN, 1e-9, 1e308]) | st.floats(-5, 5)


@often
@given(st.lists(components, min_size=6, max_size=6))
def test_all_limits_hold_at_once_and_the_curve_stays(six):
    asked = twist(*six)
    verdict = constraining(max_turn_limit=TURN, max_side_limit=SIDE).verdict(LOW, asked, 0)
    made = verdict.message or asked
    assert made.speed <= 1.0
    assert made.angular_speed <= TURN
    assert made.side_speed <= SIDE
    assert alike(asked, made)


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        (twist(2.0, 0, 0, 0, 0, 1.0), "limited to 1 m/s (max_vel_limit)"),
        (twist(2.0, 0, 0, 0, 0, 9.0), "limited to 1.5 rad/s (max_turn_limit)"),
        (twist(0.5, 0.4, 0, 0, 0, 2.0), "limited to 0.1 m/s sideways (max_side_limit)"),
        (twist(0.5, 0.05, 0, 0, 0, 1.0), "within 1 m/s (max_vel_limit)"),
    ],
)
def test_the_tightest_limit_is_the_reason(asked, reason):
    policy = constraining(max_turn_limit=TURN, max_side_limit=SIDE)
    assert policy.verdict(LOW, asked, 0).reason == reason


def test_without_settings_nothing_is_bounded():
    fast = twist(1.0, 9.0, 0, 0, 0, 99.0)
    chosen = settings(PolicyName.CONSTRAIN)
    assert MotionBounds(chosen).apply(fast) == (fast, "")
    assert AccelerationLimit(chosen).apply(fast, 0) == (fast, "")


# Acceleration


def sent_by(policy, *steps):
    """Return the linear part of what goes out of (gap, speed along x)."""
    found, now = [], 0
    for gap, speed in steps:
        now += gap
        asked = Velocity((speed, 0.0, 0.0))
        verdict = policy.verdict(LOW, asked, now)
        found.append((now, (verdict.message or asked).linear[0]))
    return found


def test_the_speed_rises_step_by_step_and_falls_at_once():
    found = sent_by(constraining(max_accel_limit=ACCEL), *[(STEP, 1.0)] * 4, (STEP, 0.01))
    assert [speed for _, speed in found] == pytest.approx([0.05, 0.075, 0.1, 0.125, 0.01])


def test_to_turn_back_is_to_begin_at_rest():
    found = sent_by(constraining(max_accel_limit=ACCEL), *[(STEP, 1.0)] * 4, (STEP, -1.0))
    assert found[-1][1] == pytest.approx(-0.025)


@pytest.mark.parametrize(("gap", "rise"), [(1, 0.0), (STEP, 0.025), (2 * STEP, 0.05)])
def test_a_pause_is_no_run_up(gap, rise):
    for longer in (0, SECOND // 2) if gap == 2 * STEP else (0,):
        policy = constraining(max_accel_limit=ACCEL)
        policy.note_sent(Velocity((0.2, 0.0, 0.0)), 0)
        ((_, speed),) = sent_by(policy, (gap + longer, 1.0))
        assert speed == pytest.approx(0.2 + rise, abs=1e-6)


@pytest.mark.parametrize(("gap", "speed"), [(SECOND - 1, 0.25), (SECOND, 0.05)])
def test_what_went_out_long_ago_counts_as_rest(gap, speed):
    policy = constraining(max_accel_limit=ACCEL)
    policy.note_sent(Velocity((0.2, 0.0, 0.0)), 0)
    ((_, found),) = sent_by(policy, (gap, 1.0))
    assert found == pytest.approx(speed)


def test_what_the_guard_sent_itself_counts():
    policy = constraining(max_accel_limit=ACCEL)
    sent_by(policy, *[(STEP, 1.0)] * 10)
    policy.note_sent(Velocity(()), 11 * STEP)
    assert policy.verdict(LOW, Velocity((1.0, 0.0, 0.0)), 12 * STEP).message.speed == (
        pytest.approx(0.025)
    )


def test_another_way_begins_with_the_part_that_goes_there_already():
    policy = constraining(max_accel_limit=ACCEL)
    policy.note_sent(Velocity((0.6, 0.0, 0.0)), 0)
    made = policy.verdict(LOW, Velocity((0.8, 0.8, 0.0)), STEP).message
    assert made.speed == pytest.approx(0.6 * math.sqrt(0.5) + 0.025)


def test_a_turn_on_the_spot_has_no_acceleration():
    policy = constraining(max_accel_limit=ACCEL)
    assert policy.verdict(LOW, twist(0, 0, 0, 0, 0, 9.0), 0).decision is Decision.PASS


def test_a_maximal_velocity_is_not_driven():
    policy = constraining(max_accel_limit=ACCEL)
    policy.reissues = True
    assert policy.verdict(LOW, Velocity((0.9,)), 0).decision is Decision.PASS


def test_the_next_policy_knows_how_fast_the_robot_is():
    before, after = (constraining(max_accel_limit=ACCEL) for _ in range(2))
    before.note_sent(Velocity((0.5, 0.0, 0.0)), STEP)
    after.restore_state(before.export_state(STEP), STEP)
    assert after.verdict(LOW, Velocity((1.0, 0.0, 0.0)), 2 * STEP).message.speed == (
        pytest.approx(0.525)
    )
    fresh = constraining(max_accel_limit=ACCEL)
    fresh.restore_state(PolicyState(), STEP)
    assert fresh.verdict(LOW, Velocity((1.0, 0.0, 0.0)), 2 * STEP).message.speed == (
        pytest.approx(0.05)
    )


steps = st.lists(
    st.tuples(
        st.sampled_from([0, 1, STEP, 2 * STEP, SECOND - 1, SECOND]),
        st.sampled_from([0.0, 0.05, 1.0, -1.0, 1e-300, 5e-324]) | st.floats(-2, 2),
    ),
    max_size=20,
)


@often
@given(steps)
def test_nothing_ever_accelerates_faster(steps):
    found = sent_by(constraining(max_accel_limit=ACCEL), *steps)
    for (before, one), (after, other) in pairwise([(-SECOND, 0.0), *found]):
        way = math.copysign(1.0, other)
        allowed = ACCEL * min(after - before, 2 * STEP) / SECOND
        assert abs(other) <= max(0.0, one * way) + allowed + 1e-9


@pytest.mark.parametrize(
    ("in_force", "allowed"),
    [
        (twist(1.0, 0, 0, 0, 0, 1.0), twist(1.0, 0, 0, 0, 0, 1.0)),
        (twist(2.0, 0, 0, 0, 0, 1.0), twist(1.0, 0, 0, 0, 0, 0.5)),
        (twist(1.0, 0, 0, 0, 0, 3.0), twist(0.5, 0, 0, 0, 0, 1.5)),
    ],
)
def test_a_velocity_in_force_is_held_within_all_limits_but_that_of_acceleration(in_force, allowed):
    policy = constraining(max_turn_limit=TURN, max_accel_limit=ACCEL)
    assert policy.bounded(in_force, 0) == allowed
    assert (policy.bounded(in_force, 0) is in_force) is (in_force == allowed)
