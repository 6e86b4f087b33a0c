"""Quantities become SI units exactly; a wrong unit names the nearest one that fits."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.planning.plan_file.quantities import (
    ANGULAR_DECELERATION,
    DECELERATION,
    MAX_DURATION,
    PER_FRAME,
    POSITION,
    VELOCITY,
    YAW,
    parse_duration,
    write_duration,
)
from rtron.vocabulary import SECOND

ALL = (VELOCITY, PER_FRAME, DECELERATION, ANGULAR_DECELERATION, POSITION, YAW)


@pytest.mark.parametrize(
    ("quantity", "text", "value"),
    [
        (VELOCITY, "0.22", 0.22),
        (VELOCITY, "0.22 m/s", 0.22),
        (VELOCITY, "22cm/s", 0.22),
        (VELOCITY, "220 mm/s", 0.22),
        (VELOCITY, "3.6 km/h", 1.0),
        (VELOCITY, "0.8 km/h", 2 / 9),
        (VELOCITY, "0", 0.0),
        (VELOCITY, "-0", 0.0),
        (VELOCITY, "1000", 1000.0),
        (VELOCITY, "3600 km/h", 1000.0),
        (VELOCITY, "1e-6 m/s", 1e-6),
        (VELOCITY, "1E0", 1.0),
        (PER_FRAME, "0.02 m/frame", 0.02),
        (PER_FRAME, "2 cm/frame", 0.02),
        (PER_FRAME, "20 mm/frame", 0.02),
        (DECELERATION, "2.5 m/s2", 2.5),
        (DECELERATION, "2.5 m/s^2", 2.5),
        (DECELERATION, "2.5 m/s²", 2.5),
        (DECELERATION, "0.01", 0.01),
        (ANGULAR_DECELERATION, "3.2 rad/s2", 3.2),
        (ANGULAR_DECELERATION, "180 deg/s2", math.pi),
        (POSITION, "-1.5 m", -1.5),
        (POSITION, "150 cm", 1.5),
        (POSITION, "15 mm", 0.015),
        (POSITION, "0.5 km", 500.0),
        (YAW, "90 deg", math.pi / 2),
        (YAW, "-360 deg", -2 * math.pi),
        (YAW, "1.5 rad", 1.5),
    ],
)
def test_a_quantity_is_read_in_si_units(quantity, text, value):
    assert quantity.parse(text) == value


@pytest.mark.parametrize(
    ("quantity", "text", "fault"),
    [
        (VELOCITY, "1 m/h", "unknown unit 'm/h': did you mean km/h?"),
        (VELOCITY, "1 kmh", "unknown unit 'kmh': did you mean km/h?"),
        (VELOCITY, "1 m/s2", "unknown unit 'm/s2': did you mean m/s?"),
        (VELOCITY, "1 mph", "unknown unit 'mph': choose from m/s"),
        (VELOCITY, "1 knots", "unknown unit 'knots': choose from m/s, cm/s, mm/s, km/h"),
        (VELOCITY, "1 M/S", "unknown unit 'M/S'"),
        (VELOCITY, "-0.1", "is not between 0 and 1000 m/s"),
        (VELOCITY, "1000.001", "is not between 0 and 1000 m/s"),
        (VELOCITY, "3601 km/h", "is not between 0 and 1000 m/s"),
        (VELOCITY, "9e999", "is not between 0 and 1000 m/s"),
        (VELOCITY, "9.9e-7", "is closer to 0 than 1e-06 m/s"),
        (VELOCITY, "1e-999 m/s", "is closer to 0 than 1e-06 m/s"),
        (VELOCITY, ".nan", "is no velocity: write a number and m/s"),
        (VELOCITY, "nan", "is no velocity"),
        (VELOCITY, ".inf", "is no velocity"),
        (VELOCITY, "-.inf", "is no velocity"),
        (VELOCITY, "inf", "is no velocity"),
        (VELOCITY, "Infinity m/s", "is no velocity"),
        (VELOCITY, "", "is no velocity"),
        (VELOCITY, "m/s", "is no velocity"),
        (VELOCITY, ".5", "is no velocity"),
        (VELOCITY, "1.", "is no velocity"),
        (VELOCITY, "1,5", "is no velocity"),
        (VELOCITY, "0x1", "unknown unit 'x1'"),
        (VELOCITY, "1_0", "is no velocity"),
        (VELOCITY, "1e9999", "unknown unit|is no velocity"),
        (VELOCITY, "9" * 1000, "is no velocity"),
        (VELOCITY, "\u0661", "is no velocity"),
        (PER_FRAME, "0", "is not between 1e-06 and 1000 m/frame"),
        (PER_FRAME, "0.02 m/s", "unknown unit 'm/s'"),
        (PER_FRAME, "0.02 m", "unknown unit 'm': choose from m/frame, cm/frame, mm/frame"),
        (DECELERATION, "0", "is not between 0.01 and 1000 m/s2"),
        (DECELERATION, "2.5 m/s", "unknown unit 'm/s': did you mean m/s"),
        (ANGULAR_DECELERATION, "1 rad/s", "unknown unit 'rad/s': did you mean rad/s"),
        (ANGULAR_DECELERATION, "1 m/s2", "unknown unit 'm/s2'"),
        (POSITION, "1e9", "is not between -1e"),
        (POSITION, "1 s", "unknown unit 's': choose from m, cm, mm, km"),
        (YAW, "90", "is not between -6.28319 and 6.283185307179586 rad"),
        (YAW, "361 deg", "is not between"),
        (YAW, "1 degrees", "unknown unit 'degrees': did you mean deg?"),
    ],
)
def test_what_is_no_such_quantity_is_told(quantity, text, fault):
    with pytest.raises(ValueError, match=fault.replace("?", r"\?").replace("^", r"\^")):
        quantity.parse(text)


@pytest.mark.parametrize("quantity", ALL, ids=lambda quantity: quantity.description)
def test_what_is_written_is_read_as_the_same_float(quantity):
    values = st.floats(quantity.minimum, quantity.maximum).filter(
        lambda value: value == 0 or abs(value) >= quantity.min_nonzero
    )

    @given(values)
    def check(value):
        assert quantity.parse(quantity.write(value)) == value

    check()


@pytest.mark.parametrize("quantity", ALL, ids=lambda quantity: quantity.description)
def test_the_bounds_themselves_are_read(quantity):
    for bound in (quantity.minimum, quantity.maximum):
        assert quantity.parse(quantity.write(bound)) == bound


@given(st.integers(0, 10**9))
def test_kilometres_an_hour_are_rounded_once(thousandths):
    text = f"{thousandths // 1000}.{thousandths % 1000:03d} km/h"
    exact = Fraction(thousandths, 3600)
    if exact == 0 or Fraction(1, 10**6) <= exact <= 1000:
        assert VELOCITY.parse(text) == float(exact)


@pytest.mark.parametrize(
    ("text", "duration"),
    [
        ("0.5", SECOND // 2),
        ("2", 2 * SECOND),
        ("200 ms", SECOND // 5),
        ("200ms", SECOND // 5),
        ("0.5 s", SECOND // 2),
        ("2 min", 120 * SECOND),
        ("1 h", 3600 * SECOND),
        ("1 ns", 1),
        ("0.001 us", 1),
        ("0", 0),
    ],
)
def test_a_duration_is_read_to_the_nanosecond(text, duration):
    assert parse_duration(text) == duration


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("200 msec", "unknown unit 'msec': did you mean ms?"),
        ("2 mins", "did you mean min?"),
        ("2 S", "unknown unit 'S'"),
        ("-1", "is no duration"),
        (".5", "is no duration"),
        ("1e3", "is no duration"),
        (".nan", "is no duration"),
        ("", "is no duration"),
        ("two", "is no duration"),
        ("1 s 2", "is no duration"),
        ("0.5 ns", "finer than a nanosecond"),
        ("9999999999999999999 h", "longer than 292 years"),
        ("9" * 100, "is no duration"),
    ],
)
def test_what_is_no_duration_is_told(text, fault):
    with pytest.raises(ValueError, match=fault.replace("?", r"\?")):
        parse_duration(text)


@given(st.integers(0, MAX_DURATION))
def test_what_is_written_is_read_again(duration):
    assert parse_duration(write_duration(duration)) == duration
