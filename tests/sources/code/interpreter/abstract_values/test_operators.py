"""Operators on values known in part: what is known is exact, the rest is a hole, all is bounded."""

import operator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import (
    MAX_LENGTH,
    binary,
    percent_format,
    unary,
)
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    MAX_CHOICES,
    NONE,
    OPEN,
    TRUE,
    Choice,
    ExternalSymbol,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    is_tainted,
    options,
    text_with_holes,
)

HOLE = Unknown("h")
TEXT = PartialText(("a", HOLE))
OPEN_LIST = ListValue({"items": (Scalar("a"),), "open": True})
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
    assert binary(name, Scalar(left), Scalar(right)) == Scalar(COMPARED[name](left, right))


@given(st.sampled_from([*COMPARED]), st.text(max_size=3), st.text(max_size=3))
def test_strings_compare_as_they_do(name, left, right):
    assert binary(name, Scalar(left), Scalar(right)) == Scalar(COMPARED[name](left, right))


@given(st.sampled_from([*COMPUTED]), st.integers(-99, 99), st.integers(1, 99))
def test_numbers_compute_as_they_do(name, left, right):
    assert binary(name, Scalar(left), Scalar(right)) == Scalar(COMPUTED[name](left, right))


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
    assert isinstance(binary(name, Scalar(left), Scalar(right)), Unknown)


@pytest.mark.parametrize(
    "name", [*COMPARED, *sorted(COMPUTED.keys() - {"%"}), "in", "not in", "is", "is not"]
)
@pytest.mark.parametrize("side", [HOLE, PartialText((HOLE,)), ExternalSymbol("f")])
def test_what_is_unknown_decides_nothing(name, side):
    for left, right in ((side, Scalar("a")), (Scalar("a"), side), (side, side)):
        assert not isinstance(binary(name, left, right), Scalar)


def test_an_unknown_is_not_even_like_itself():
    assert isinstance(binary("==", HOLE, HOLE), Unknown)


def test_options_are_combined():
    some = Choice((Scalar(1), Scalar(2)))
    assert set(options(binary("+", some, some))) == {Scalar(2), Scalar(3), Scalar(4)}
    assert binary(">", some, Scalar(0)) == TRUE
    assert set(options(binary(">", some, Scalar(1)))) == {TRUE, FALSE}


def test_many_options_stay_few():
    many = Choice(tuple(Scalar(n) for n in range(MAX_CHOICES)))
    found = binary("+", binary("*", many, Scalar(100)), many)
    assert len(options(found)) <= 2 * MAX_CHOICES


@pytest.mark.parametrize("name", ["+", "==", "*"])
def test_taint_goes_on(name):
    assert is_tainted(binary(name, Scalar(2, tainted=True), Scalar(3)))
    assert is_tainted(binary(name, Scalar(2), Scalar(3, tainted=True)))
    assert not is_tainted(binary(name, Scalar(2), Scalar(3)))


@pytest.mark.parametrize(
    ("item", "container", "fake_study"),
    [
        (Scalar("a"), list_of([Scalar("a")]), True),
        (Scalar("b"), list_of([Scalar("a")]), False),
        (Scalar("b"), list_of([]), False),
        (Scalar("a"), OPEN_LIST, True),
        (Scalar("b"), OPEN_LIST, None),
        (Scalar("b"), list_of([HOLE]), None),
        (Scalar("a"), list_of([HOLE, Scalar("a")]), True),
        (Scalar("k"), MapValue({"k": TRUE}), True),
        (Scalar("x"), MapValue({"k": TRUE}), False),
        (Scalar("x"), MapValue({OPEN: TRUE}), None),
        (Scalar("b"), Scalar("abc"), True),
        (Scalar("x"), Scalar("abc"), False),
        (Scalar(""), Scalar(""), True),
        (HOLE, list_of([Scalar("a")]), None),
        (Scalar("a"), HOLE, None),
        (Scalar("a"), Scalar(5), None),
    ],
)
def test_membership(item, container, fake_study):
    for name, expected in (
        ("in", fake_study),
        ("not in", None if fake_study is None else not fake_study),
    ):
        answer = binary(name, item, container)
        assert (answer.value if isinstance(answer, Scalar) else None) is expected


def test_lists_are_added_and_repeated():
    two = binary("+", list_of([TRUE]), list_of([FALSE]))
    assert items_of(two) == ((TRUE, FALSE), True)
    assert items_of(binary("+", two, OPEN_LIST))[1] is False
    assert items_of(binary("*", list_of([NONE]), Scalar(3))) == ((NONE,) * 3, True)
    assert items_of(binary("*", list_of([NONE]), Scalar(-1))) == ((), True)
    assert items_of(binary("*", list_of([NONE]), HOLE))[1] is False


def test_a_list_that_grows_stays_bounded():
    grown = list_of([TRUE])
    for _ in range(20):
        grown = binary("+", grown, grown)
    assert len(grown.items) < 100_000
    assert len(binary("*", list_of([NONE] * 3), Scalar(10**12)).items) <= MAX_LENGTH


def test_a_string_that_grows_stays_bounded():
    grown = Scalar("ab")
    for _ in range(18):
        grown = binary("+", grown, grown)
    assert len(text_with_holes(grown)) < 100_000


@pytest.mark.parametrize(
    ("template", "given", "whole"),
    [
        ("a", NONE, "a"),
        ("%s", Scalar("x"), "x"),
        ("%s/%s", list_of([Scalar("x"), Scalar("y")], "tuple"), "x/y"),
        ("%d_%03d", list_of([Scalar(4), Scalar(7)], "tuple"), "4_007"),
        ("%5.1f|", Scalar(2.25), "  2.2|"),
        ("%%%s%%", Scalar("x"), "%x%"),
        ("%(a)s-%(b)d", MapValue({"a": Scalar("x"), "b": Scalar(2)}), "x-2"),
        ("%s", HOLE, "{h}"),
        ("%s_%s", list_of([HOLE, Scalar("x")], "tuple"), "{h}_x"),
        ("%d", HOLE, "{h}"),
        ("%s%s", Scalar("x"), "x{?}"),
        ("%(a)s", MapValue(), "{a}"),
        ("%i%u%x", list_of([Scalar(1), Scalar(2), Scalar(255)], "tuple"), "12ff"),
        ("%ld", Scalar(5), "5"),
        ("%", NONE, "{?}"),
        ("100%", NONE, "100{?}"),
    ],
)
def test_percent(template, given, whole):
    found = text_with_holes(percent_format(Scalar(template), given))
    assert found == whole or (whole.endswith("{?}") and found.startswith(whole[:-3]))


def test_percent_with_a_choice_has_every_option():
    found = percent_format(Scalar("%s"), Choice((Scalar("a"), Scalar("b"))))
    assert set(options(found)) == {Scalar("a"), Scalar("b")}


@pytest.mark.parametrize("template", ["%10000000000d", "%.9999999999f", "%*d", "%-99999999s", "%("])
def test_hostile_templates_stay_small(template):
    assert len(text_with_holes(percent_format(Scalar(template), Scalar(1)))) < 100_000


@given(st.text(alphabet="%()sdxf.0123456789*- a{}", max_size=12), st.sampled_from([1, "a", None]))
def test_any_template_ends(template, value):
    assert len(text_with_holes(percent_format(Scalar(template), Scalar(value)))) < 100_000


@pytest.mark.parametrize(
    ("name", "operand", "fake_study"),
    [
        ("-", Scalar(2), Scalar(-2)),
        ("+", Scalar(2.5), Scalar(2.5)),
        ("-", Choice((Scalar(1), Scalar(2))), Choice((Scalar(-1), Scalar(-2)))),
    ],
)
def test_unary(name, operand, fake_study):
    assert unary(name, operand) == fake_study


@pytest.mark.parametrize("operand", [HOLE, Scalar("a"), NONE, ListValue(), TEXT])
@pytest.mark.parametrize("name", ["-", "+", "~"])
def test_unary_of_what_is_no_number_is_a_hole(name, operand):
    assert isinstance(unary(name, operand), Unknown)
