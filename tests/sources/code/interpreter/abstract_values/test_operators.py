"""Operators on values known in part: what is known is exact, the rest is a hole, all is bounded."""

import operator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.operators import (
    MAX_LENGTH,
    binary,
    percent,
    unary,
)
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    MAX_CHOICES,
    NONE,
    OPEN,
    TRUE,
    Choice,
    Foreign,
    Hole,
    Known,
    ListValue,
    MapValue,
    Text,
    is_tainted,
    options,
    spelled,
)

HOLE = Hole("h")
TEXT = Text(("a", HOLE))
OPEN_LIST = ListValue({"items": (Known("a"),), "open": True})
COMPARED = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
COMPUTED = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "//": operator.floordiv,
    "%": operator.mod,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
}


@given(st.sampled_from([*COMPARED]), st.integers(-9, 9), st.integers(-9, 9))
def test_numbers_compare_as_they_do(name, left, right):
    assert binary(name, Known(left), Known(right)) == Known(COMPARED[name](left, right))


@given(st.sampled_from([*COMPARED]), st.text(max_size=3), st.text(max_size=3))
def test_strings_compare_as_they_do(name, left, right):
    assert binary(name, Known(left), Known(right)) == Known(COMPARED[name](left, right))


@given(st.sampled_from([*COMPUTED]), st.integers(-99, 99), st.integers(1, 99))
def test_numbers_compute_as_they_do(name, left, right):
    assert binary(name, Known(left), Known(right)) == Known(COMPUTED[name](left, right))


@pytest.mark.parametrize(
    ("name", "left", "right"),
    [
        ("/", 1, 0),
        ("//", 1, 0),
        ("%", 1, 0),
        ("+", 1, None),
        ("-", "a", "b"),
        ("<", 1, "a"),
        ("*", 2**200, 2**200),
        ("*", "a", MAX_LENGTH + 1),
        ("*", 10**9, "ab"),
        (">>", 1, -1),
        ("@", 1, 1),
        ("no such operator", 1, 1),
    ],
)
def test_what_cannot_be_computed_is_a_hole(name, left, right):
    assert isinstance(binary(name, Known(left), Known(right)), Hole)


@pytest.mark.parametrize(
    "name", [*COMPARED, *sorted(COMPUTED.keys() - {"%"}), "in", "not in", "is", "is not"]
)
@pytest.mark.parametrize("side", [HOLE, Text((HOLE,)), Foreign("f")])
def test_what_is_unknown_decides_nothing(name, side):
    for left, right in ((side, Known("a")), (Known("a"), side), (side, side)):
        assert not isinstance(binary(name, left, right), Known)


def test_an_unknown_is_not_even_like_itself():
    assert isinstance(binary("==", HOLE, HOLE), Hole)


def test_options_are_combined():
    some = Choice((Known(1), Known(2)))
    assert set(options(binary("+", some, some))) == {Known(2), Known(3), Known(4)}
    assert binary(">", some, Known(0)) == TRUE
    assert set(options(binary(">", some, Known(1)))) == {TRUE, FALSE}


def test_many_options_stay_few():
    many = Choice(tuple(Known(n) for n in range(MAX_CHOICES)))
    found = binary("+", binary("*", many, Known(100)), many)
    assert len(options(found)) <= 2 * MAX_CHOICES


@pytest.mark.parametrize("name", ["+", "==", "*"])
def test_taint_goes_on(name):
    assert is_tainted(binary(name, Known(2, tainted=True), Known(3)))
    assert is_tainted(binary(name, Known(2), Known(3, tainted=True)))
    assert not is_tainted(binary(name, Known(2), Known(3)))


@pytest.mark.parametrize(
    ("item", "container", "found"),
    [
        (Known("a"), listed([Known("a")]), True),
        (Known("b"), listed([Known("a")]), False),
        (Known("b"), listed([]), False),
        (Known("a"), OPEN_LIST, True),
        (Known("b"), OPEN_LIST, None),
        (Known("b"), listed([HOLE]), None),
        (Known("a"), listed([HOLE, Known("a")]), True),
        (Known("k"), MapValue({"k": TRUE}), True),
        (Known("x"), MapValue({"k": TRUE}), False),
        (Known("x"), MapValue({OPEN: TRUE}), None),
        (Known("b"), Known("abc"), True),
        (Known("x"), Known("abc"), False),
        (Known(""), Known(""), True),
        (HOLE, listed([Known("a")]), None),
        (Known("a"), HOLE, None),
        (Known("a"), Known(5), None),
    ],
)
def test_membership(item, container, found):
    for name, expected in (("in", found), ("not in", None if found is None else not found)):
        answer = binary(name, item, container)
        assert (answer.value if isinstance(answer, Known) else None) is expected


def test_lists_are_added_and_repeated():
    two = binary("+", listed([TRUE]), listed([FALSE]))
    assert items_of(two) == ((TRUE, FALSE), True)
    assert items_of(binary("+", two, OPEN_LIST))[1] is False
    assert items_of(binary("*", listed([NONE]), Known(3))) == ((NONE,) * 3, True)
    assert items_of(binary("*", listed([NONE]), Known(-1))) == ((), True)
    assert items_of(binary("*", listed([NONE]), HOLE))[1] is False


def test_a_list_that_grows_stays_bounded():
    grown = listed([TRUE])
    for _ in range(20):
        grown = binary("+", grown, grown)
    assert len(grown.items) < 100_000
    assert len(binary("*", listed([NONE] * 3), Known(10**12)).items) <= MAX_LENGTH


def test_a_string_that_grows_stays_bounded():
    grown = Known("ab")
    for _ in range(18):
        grown = binary("+", grown, grown)
    assert len(spelled(grown)) < 100_000


@pytest.mark.parametrize(
    ("template", "given", "whole"),
    [
        ("a", NONE, "a"),
        ("%s", Known("x"), "x"),
        ("%s/%s", listed([Known("x"), Known("y")], "tuple"), "x/y"),
        ("%d_%03d", listed([Known(4), Known(7)], "tuple"), "4_007"),
        ("%5.1f|", Known(2.25), "  2.2|"),
        ("%%%s%%", Known("x"), "%x%"),
        ("%(a)s-%(b)d", MapValue({"a": Known("x"), "b": Known(2)}), "x-2"),
        ("%s", HOLE, "{h}"),
        ("%s_%s", listed([HOLE, Known("x")], "tuple"), "{h}_x"),
        ("%d", HOLE, "{h}"),
        ("%s%s", Known("x"), "x{?}"),
        ("%(a)s", MapValue(), "{a}"),
        ("%i%u%x", listed([Known(1), Known(2), Known(255)], "tuple"), "12ff"),
        ("%ld", Known(5), "5"),
        ("%", NONE, "{?}"),
        ("100%", NONE, "100{?}"),
    ],
)
def test_percent(template, given, whole):
    found = spelled(percent(Known(template), given))
    assert found == whole or (whole.endswith("{?}") and found.startswith(whole[:-3]))


def test_percent_with_a_choice_has_every_option():
    found = percent(Known("%s"), Choice((Known("a"), Known("b"))))
    assert set(options(found)) == {Known("a"), Known("b")}


@pytest.mark.parametrize("template", ["%10000000000d", "%.9999999999f", "%*d", "%-99999999s", "%("])
def test_hostile_templates_stay_small(template):
    assert len(spelled(percent(Known(template), Known(1)))) < 100_000


@given(st.text(alphabet="%()sdxf.0123456789*- a{}", max_size=12), st.sampled_from([1, "a", None]))
def test_any_template_ends(template, value):
    assert len(spelled(percent(Known(template), Known(value)))) < 100_000


@pytest.mark.parametrize(
    ("name", "operand", "found"),
    [
        ("-", Known(2), Known(-2)),
        ("+", Known(2.5), Known(2.5)),
        ("-", Choice((Known(1), Known(2))), Choice((Known(-1), Known(-2)))),
    ],
)
def test_unary(name, operand, found):
    assert unary(name, operand) == found


@pytest.mark.parametrize("operand", [HOLE, Known("a"), NONE, ListValue(), TEXT])
@pytest.mark.parametrize("name", ["-", "+", "~"])
def test_unary_of_what_is_no_number_is_a_hole(name, operand):
    assert isinstance(unary(name, operand), Hole)
