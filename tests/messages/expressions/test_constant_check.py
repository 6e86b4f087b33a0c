"""Expressions that have one value whatever the message says, and those that may be either."""

import pytest

from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.expressions.constant_check import constant_value
from rtron.messages.expressions.evaluator import check_expression

DEFINITION = parse_definition(
    "test/State",
    "float32 speed\nuint8 level\nint32 count\nbool ok\nstring mode\nfloat32[] cells\ntest/Sub sub\n"
    f"{'=' * 80}\nMSG: test/Sub\nuint8 level\n",
)
NEVER = [
    "false",
    "!true",
    f"{'!' * 1501}true",
    "(false)",
    "false || false",
    "true && !(true)",
    "event.ok && !event.ok",
    "event.speed != event.speed",
    "event.speed < event.speed",
    "1 > 2",
    "1.0 > 2.0 || 'a' == 'b'",
    "event.ok ? false : false",
    "event.ok ? !event.ok : event.speed > 3.0 ? event.ok : event.speed > 4.0",
    "size(event.cells) < 0",
    "event.cells.size() < 0 && event.ok",
    "event.speed > 5.0 && event.ok && event.speed in [1.0, 2.0]",
    "event.ok == true && event.ok == false",
    "event.speed > 5.0 && event.speed < 3.0",
    "event.speed > 5.0 && 3.0 > event.speed",
    "event.speed < 1.0 && event.speed >= 1e0",
    "event.speed == 1.0 && event.speed == 2.0",
    "!(event.speed > 1.0 || event.speed <= 1.0)",
    "(event.speed) > 2.0 && event.ok && (event.speed < 1.0 || event.speed < -1.0)",
    "event.level < 0",
    "event.level > 255",
    "event.sub.level == 256",
    "event.level > 1 && event.level < 2",
    "event.count > 1 && event.count < 2",
    "event.mode == 'a' && event.mode == \"b\"",
    "event.mode in ['a', 'b'] && event.mode == 'c'",
    "event.mode == '\\x61' && event.mode == 'b'",
    "event.cells.exists(c, c > 1.0) && !event.cells.exists(c, c > 1.0)",
]
ALWAYS = [
    "true",
    "true // for now",
    "event.ok || !event.ok",
    "event.speed == event.speed",
    "2 > 1",
    "true == true",
    "event.ok ? true : !event.ok",
    "size(event.cells) >= 0",
    "event.speed > -1.0 || event.speed < 0.0",
    "event.level >= 0",
    "event.level > -1",
    "event.level <= 255",
    "event.count != 1 || event.count != 2",
    "event.mode != 'a' || event.mode != 'b'",
]
EITHER = [
    "event.ok",
    "event.speed > -1.0",
    "event.speed > 3.0 && event.speed < 5.0",
    "event.speed > 1.0 && event.speed < 2.0",
    "event.speed >= 1.0 && event.speed <= 1.0",
    "event.level == 0 || event.level == 255",
    "event.level > 1 && event.level < 3",
    "event.count >= 0",
    "event.mode == 'a' || event.mode == 'b'",
    "event.mode == 'a' && event.mode == \"a\"",
    "event.mode == 'a' && event.mode == r'a'",
    "event.mode == '\\x61' && event.mode == 'a'",
    "event.mode > 'a' && event.mode < 'b'",
    "event.mode in ['a', 'b'] && event.mode == 'a'",
    "event.ok ? false : true",
    "event.ok ? event.speed > 1.0 : true",
    "event.cells.size() - 5 < 0",
    "size(event.cells) - size(event.cells) < 0",
    "size(event.cells) == 0",
    "event.speed + 1.0 > 5.0 && event.speed < 3.0",
    "event.cells.exists(c, c > 5.0 && c < 3.0)",
    "event.cells[0] > 5.0 && event.cells[1] < 3.0",
    "size(event.cells) > 3",
    "!event.ok == false",
]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *((text, False) for text in NEVER),
        *((text, True) for text in ALWAYS),
        *((text, None) for text in EITHER),
    ],
)
def test_the_one_value_of_an_expression(text, value):
    check_expression(DEFINITION, text, "event")
    assert constant_value(text, DEFINITION, "event") is value


def test_an_expression_with_very_many_terms_is_not_tried():
    terms = [f"event.cells[{n}] > 1.0" for n in range(30)]
    text = " || ".join(terms)
    assert constant_value(f"({text}) && !({text})", DEFINITION, "event") is None


def test_a_long_expression_is_tried_in_fewer_cases():
    terms = [f"event.cells[{n}] > 1.0" for n in range(5)]
    text = " || ".join(terms)
    assert constant_value(f"({text}) && !({text})", DEFINITION, "event") is False
    many = " || ".join(terms * 40)
    assert constant_value(f"({many}) && !({many})", DEFINITION, "event") is None
