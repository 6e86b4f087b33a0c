"""Durations are exact in both directions, and every fault names the unit that was meant."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.planning.plan_file.quantities import MAX_DURATION, parse_duration, write_duration
from rtron.vocabulary import SECOND


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
