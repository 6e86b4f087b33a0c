"""A comparison with NaN is not known, unless something else decides or the expression asks."""

import math
import struct

import pytest

from rtron.messages import Encoding, MessageEvaluator, parse_definition
from rtron.messages.expressions.number_checks import NOT_A_NUMBER, check_numbers

pytest.importorskip("cel_expr_python.cel", reason="no CEL on this machine")
BATTERY = parse_definition("a/Battery", "float32 percentage\nfloat64 other\nfloat32[] ranges\n")


def judge(text, percentage=math.nan, other=1.0, ranges=()):
    body = struct.pack(f"<fdI{len(ranges)}f", percentage, other, len(ranges), *ranges)
    evaluator = MessageEvaluator(BATTERY, [text], subject="event", encoding=Encoding.ROS1)
    (found,) = evaluator.evaluate(struct.pack("<I", len(body)) + body)
    return found


@pytest.mark.parametrize(
    "text",
    [
        "event.percentage < 0.2",
        "!(event.percentage >= 0.2)",
        "0.2 > event.percentage",
        "event.percentage == 0.2",
        "event.percentage != 0.2",
        "event.percentage in [0.1, 0.2]",
        "event.percentage // a comment\n < 0.2",
        "-event.percentage < 0.2 || event.other < 0.0",
        "event.percentage - event.other < 0.2",
        "event.other < event.percentage",
        "(event.percentage < 0.2) == false",
        "event.other < 0.5 ? true : event.percentage < 0.2",
        "[event].exists(e, e.percentage < 0.2)",
        "math.greatest(event.other, event.percentage) < 0.2",
        "math . least([event.other, event.percentage]) < 0.2",
        "math.abs(event.percentage) < 0.2 && event.other == 1.0",
    ],
)
def test_what_compares_nan_is_not_known(text):
    assert judge(text) == NOT_A_NUMBER
    assert judge(f"!({text}\n)") == NOT_A_NUMBER
    assert judge(text, percentage=0.1) in (True, False)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("event.percentage < 0.2 || event.other > 0.5", True),
        ("event.percentage < 0.2 && event.other > 1.5", False),
        ("event.other > 0.5 ? true : event.percentage < 0.2", True),
        ("math.isNaN(event.percentage) || event.percentage < 0.2", True),
        ("math.isFinite(event.percentage) && event.percentage < 0.2", False),
        ("event.other < 2.0", True),
        ("size(event.ranges) == 0", True),
        ("math.greatest(1, 2.0, event.other) == 2.0", True),
    ],
)
def test_what_something_else_decides_is_known(text, value):
    assert judge(text) is value


def test_one_of_many_numbers_is_nan():
    near = "event.ranges.exists(r, r < 0.5)"
    assert judge(near, ranges=(2.0, math.nan, 0.1)) is True
    assert judge(near, ranges=(2.0, math.nan)) == NOT_A_NUMBER
    assert judge(near, ranges=(2.0, 1.0)) is False
    said = "event.ranges.exists(r, !math.isNaN(r) && r < 0.5)"
    assert judge(said, ranges=(2.0, math.nan)) is False


def test_infinite_numbers_compare():
    assert judge("event.percentage < 0.2", percentage=-math.inf) is True
    assert judge("event.percentage < 0.2", percentage=math.inf) is False


def test_what_compares_nothing_stays_as_it_is():
    for text in ("event.flag", "!event.a && (event.b || event.c)", "f('a < b', \"c == d\")"):
        assert check_numbers(text) == text


def test_nested_comparisons_grow_no_faster_than_their_text():
    text = "event.other == 1.0"
    for _ in range(12):
        text = f"({text}) == true"
    assert judge(text) is True
    assert len(check_numbers(text)) < 150 * len(text)
    assert judge(text.replace("other", "percentage")) == NOT_A_NUMBER
