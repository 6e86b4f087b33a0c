"""A velocity's length, and that no rounding leaves it above a limit."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from example_budget import examples
from rtron.vocabulary import Velocity

EDGES = [0.0, -0.0, 5e-324, 1e-323, 2.5e-323, 2.2e-308, 1e-300, 1e-9, 0.22, 1.0, 1e154, 1.7e308]
finite = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(-2.0, 2.0),
    st.sampled_from(EDGES).flatmap(lambda edge: st.sampled_from([edge, -edge])),
    st.integers(-40, 40).map(lambda units: units * 5e-324),
)
limits = st.one_of(
    st.floats(0.0, 2.0),
    st.floats(min_value=0.0, allow_infinity=False),
    st.sampled_from(EDGES).map(abs),
    st.integers(0, 40).map(lambda units: units * 5e-324),
)
velocities = st.builds(
    Velocity,
    st.lists(finite, min_size=1, max_size=3).map(tuple),
    st.lists(finite, max_size=3).map(tuple),
)


@settings(max_examples=examples(2000))
@given(velocity=velocities, limit=limits)
def test_never_above_the_limit(velocity, limit):
    found = velocity.at_most(limit)
    assert found.speed <= limit
    assert found.is_finite


@given(velocity=velocities, limit=limits)
def test_below_the_limit_it_stays(velocity, limit):
    if velocity.speed <= limit:
        assert velocity.at_most(limit) is velocity
    assert velocity.at_most(math.inf) is velocity or math.isinf(velocity.speed)


@given(velocity=velocities, limit=limits)
def test_nothing_grows_and_no_sign_turns(velocity, limit):
    found = velocity.at_most(limit)
    assert len(found.linear) == len(velocity.linear)
    assert len(found.angular) == len(velocity.angular)
    for before, after in zip(
        velocity.linear + velocity.angular, found.linear + found.angular, strict=True
    ):
        assert abs(after) <= abs(before)
        assert math.copysign(1.0, after) == math.copysign(1.0, before)


@given(
    linear=st.floats(-1e6, 1e6).filter(lambda x: abs(x) > 1e-6),
    angular=st.floats(-1e6, 1e6),
    limit=st.floats(1e-6, 1e6),
)
def test_curvature_stays(linear, angular, limit):
    found = Velocity((linear, 0.0, 0.0), (0.0, 0.0, angular)).at_most(limit)
    assert found.angular[2] / found.linear[0] == pytest.approx(
        angular / linear, rel=1e-12, abs=1e-300
    )


@given(velocity=velocities, limit=st.floats(1e-9, 1e9))
def test_the_limit_is_used(velocity, limit):
    """What is slowed down is not slowed down further than rounding asks for."""
    if limit < velocity.speed < math.inf:
        assert velocity.at_most(limit).speed == pytest.approx(limit, rel=1e-12)


@pytest.mark.parametrize("units", range(1, 60))
def test_where_floats_are_coarse(units):
    """Every rounding is up to half of the value there; it still ends."""
    value = units * 5e-324
    for limit in (step * 5e-324 for step in range(60)):
        for linear in ((value,), (value, value), (-value, -value, -value)):
            assert Velocity(linear).at_most(limit).speed <= limit


@pytest.mark.parametrize(
    ("limit", "linear", "angular"),
    [(2.0, 1.0, -0.5), (1.0, 1.0, -0.5), (0.5, 0.5, -0.25), (0.0, 0.0, -0.0)],
)
def test_scaled_as_a_whole(limit, linear, angular):
    found = Velocity((1.0, 0.0, 0.0), (0.0, 0.0, -0.5)).at_most(limit)
    assert found == Velocity((linear, 0.0, 0.0), (0.0, 0.0, angular))


def test_reverse():
    assert Velocity((-2.0,)).at_most(0.5) == Velocity((-0.5,))


def test_speed_above_all_floats():
    huge = Velocity((1.7e308, 1.7e308, -1.7e308), (1.7e308,))
    assert math.isinf(huge.speed)
    found = huge.at_most(1.0)
    assert found.speed == pytest.approx(1.0)
    assert found.linear[2] == -found.linear[0] == pytest.approx(-(3**-0.5))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_not_finite(value):
    assert not Velocity((value,)).is_finite
    assert not Velocity((0.0, value), (0.0,)).is_finite
    assert not Velocity((0.0,), (0.0, value)).is_finite
    assert Velocity((value,)).is_moving
    assert Velocity((0.0,), (value,)).is_moving


@pytest.mark.parametrize(
    ("linear", "angular", "speed", "turn", "moves"),
    [
        ((0.0,), (), 0.0, 0.0, False),
        ((-0.0, 0.0), (-0.0,), 0.0, 0.0, False),
        ((3.0, -4.0), (), 5.0, 0.0, True),
        ((0.0,), (0.0, 0.0, -2.0), 0.0, 2.0, True),
        ((5e-324,), (), 5e-324, 0.0, True),
        ((), (), 0.0, 0.0, False),
    ],
)
def test_lengths(linear, angular, speed, turn, moves):
    velocity = Velocity(linear, angular)
    assert (velocity.speed, velocity.angular_speed, velocity.is_moving) == (speed, turn, moves)
    assert velocity.is_finite


@given(velocity=velocities, factor=st.floats(-2.0, 2.0))
def test_scaled(velocity, factor):
    found = velocity.scaled(factor)
    assert found.linear == tuple(each * factor for each in velocity.linear)
    assert found.angular == tuple(each * factor for each in velocity.angular)
