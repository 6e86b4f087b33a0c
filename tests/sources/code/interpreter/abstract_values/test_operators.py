"""Operators on values known in part: what is known is exact, the rest is a hole, all is bounded."""

import operator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.operators import unary
from rtron.sources.code.interpreter.abstract_values.value_types import MAX_CHOICES

HOLE = av.Unknown("h")
TEXT = av.PartialText(("a", HOLE))
OPEN_LIST = av.ListValue({"items": (av.Scalar("a"),), "open": True})
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
    assert av.binary(name, av.Scalar(left), av.Scalar(right)) == av.Scalar(
        COMPARED[name](left, right)
    )


@given(st.sampled_from([*COMPARED]), st.text(max_size=3), st.text(max_size=3))
def test_strings_compare_as_they_do(name, left, right):
    assert av.binary(name, av.Scalar(left), av.Scalar(right)) == av.Scalar(
        COMPARED[name](left, right)
    )


@given(st.sampled_from([*COMPUTED]), st.integers(-99, 99), st.integers(1, 99))
def test_numbers_compute_as_they_do(name, left, right):
    assert av.binary(name, av.Scalar(left), av.Scalar(right)) == av.Scalar(
        COMPUTED[name](left, right)
    )


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
        ("*", "a", av.MAX_LENGTH + 1),
        ("*", 10**9, "ab"),
        (">>", 1, -1),
        ("@", 1, 1),
        ("no such operator", 1, 1),
    ],
)
def test_what_cannot_be_computed_is_a_hole(name, left, right):
    assert isinstance(av.binary(name, av.Scalar(left), av.Scalar(right)), av.Unknown)


@pytest.mark.parametrize(
    "name", [*COMPARED, *sorted(COMPUTED.keys() - {"%"}), "in", "not in", "is", "is not"]
)
@pytest.mark.parametrize("side", [HOLE, av.PartialText((HOLE,)), av.ExternalSymbol("f")])
def test_what_is_unknown_decides_nothing(name, side):
    for left, right in ((side, av.Scalar("a")), (av.Scalar("a"), side), (side, side)):
        assert not isinstance(av.binary(name, left, right), av.Scalar)


def test_an_unknown_is_not_even_like_itself():
    assert isinstance(av.binary("==", HOLE, HOLE), av.Unknown)


def test_options_are_combined():
    some = av.Choice((av.Scalar(1), av.Scalar(2)))
    assert set(av.options(av.binary("+", some, some))) == {av.Scalar(2), av.Scalar(3), av.Scalar(4)}
    assert av.binary(">", some, av.Scalar(0)) == av.TRUE
    assert set(av.options(av.binary(">", some, av.Scalar(1)))) == {av.TRUE, av.FALSE}


def test_many_options_stay_few():
    many = av.Choice(tuple(av.Scalar(n) for n in range(MAX_CHOICES)))
    found = av.binary("+", av.binary("*", many, av.Scalar(100)), many)
    assert len(av.options(found)) <= 2 * MAX_CHOICES


@pytest.mark.parametrize("name", ["+", "==", "*"])
def test_taint_goes_on(name):
    assert av.is_tainted(av.binary(name, av.Scalar(2, tainted=True), av.Scalar(3)))
    assert av.is_tainted(av.binary(name, av.Scalar(2), av.Scalar(3, tainted=True)))
    assert not av.is_tainted(av.binary(name, av.Scalar(2), av.Scalar(3)))


@pytest.mark.parametrize(
    ("item", "container", "fake_study"),
    [
        (av.Scalar("a"), av.list_of([av.Scalar("a")]), True),
        (av.Scalar("b"), av.list_of([av.Scalar("a")]), False),
        (av.Scalar("b"), av.list_of([]), False),
        (av.Scalar("a"), OPEN_LIST, True),
        (av.Scalar("b"), OPEN_LIST, None),
        (av.Scalar("b"), av.list_of([HOLE]), None),
        (av.Scalar("a"), av.list_of([HOLE, av.Scalar("a")]), True),
        (av.Scalar("k"), av.MapValue({"k": av.TRUE}), True),
        (av.Scalar("x"), av.MapValue({"k": av.TRUE}), False),
        (av.Scalar("x"), av.MapValue({av.OPEN: av.TRUE}), None),
        (av.Scalar("b"), av.Scalar("abc"), True),
        (av.Scalar("x"), av.Scalar("abc"), False),
        (av.Scalar(""), av.Scalar(""), True),
        (HOLE, av.list_of([av.Scalar("a")]), None),
        (av.Scalar("a"), HOLE, None),
        (av.Scalar("a"), av.Scalar(5), None),
    ],
)
def test_membership(item, container, fake_study):
    for name, expected in (
        ("in", fake_study),
        ("not in", None if fake_study is None else not fake_study),
    ):
        answer = av.binary(name, item, container)
        assert (answer.value if isinstance(answer, av.Scalar) else None) is expected


def test_lists_are_added_and_repeated():
    two = av.binary("+", av.list_of([av.TRUE]), av.list_of([av.FALSE]))
    assert av.items_of(two) == ((av.TRUE, av.FALSE), True)
    assert av.items_of(av.binary("+", two, OPEN_LIST))[1] is False
    assert av.items_of(av.binary("*", av.list_of([av.NONE]), av.Scalar(3))) == (
        (av.NONE,) * 3,
        True,
    )
    assert av.items_of(av.binary("*", av.list_of([av.NONE]), av.Scalar(-1))) == ((), True)
    assert av.items_of(av.binary("*", av.list_of([av.NONE]), HOLE))[1] is False


def test_a_list_that_grows_stays_bounded():
    grown = av.list_of([av.TRUE])
    for _ in range(20):
        grown = av.binary("+", grown, grown)
    assert len(grown.items) < 100_000
    assert len(av.binary("*", av.list_of([av.NONE] * 3), av.Scalar(10**12)).items) <= av.MAX_LENGTH


def test_a_string_that_grows_stays_bounded():
    grown = av.Scalar("ab")
    for _ in range(18):
        grown = av.binary("+", grown, grown)
    assert len(av.text_with_holes(grown)) < 100_000


@pytest.mark.parametrize(
    ("template", "given", "whole"),
    [
        ("a", av.NONE, "a"),
        ("%s", av.Scalar("x"), "x"),
        ("%s/%s", av.list_of([av.Scalar("x"), av.Scalar("y")], "tuple"), "x/y"),
        ("%d_%03d", av.list_of([av.Scalar(4), av.Scalar(7)], "tuple"), "4_007"),
        ("%5.1f|", av.Scalar(2.25), "  2.2|"),
        ("%%%s%%", av.Scalar("x"), "%x%"),
        ("%(a)s-%(b)d", av.MapValue({"a": av.Scalar("x"), "b": av.Scalar(2)}), "x-2"),
        ("%s", HOLE, "{h}"),
        ("%s_%s", av.list_of([HOLE, av.Scalar("x")], "tuple"), "{h}_x"),
        ("%d", HOLE, "{h}"),
        ("%s%s", av.Scalar("x"), "x{?}"),
        ("%(a)s", av.MapValue(), "{a}"),
        ("%i%u%x", av.list_of([av.Scalar(1), av.Scalar(2), av.Scalar(255)], "tuple"), "12ff"),
        ("%ld", av.Scalar(5), "5"),
        ("%", av.NONE, "{?}"),
        ("100%", av.NONE, "100{?}"),
    ],
)
def test_percent(template, given, whole):
    found = av.text_with_holes(av.percent_format(av.Scalar(template), given))
    assert found == whole or (whole.endswith("{?}") and found.startswith(whole[:-3]))


def test_percent_with_a_choice_has_every_option():
    found = av.percent_format(av.Scalar("%s"), av.Choice((av.Scalar("a"), av.Scalar("b"))))
    assert set(av.options(found)) == {av.Scalar("a"), av.Scalar("b")}


@pytest.mark.parametrize("template", ["%10000000000d", "%.9999999999f", "%*d", "%-99999999s", "%("])
def test_hostile_templates_stay_small(template):
    assert len(av.text_with_holes(av.percent_format(av.Scalar(template), av.Scalar(1)))) < 100_000


@given(st.text(alphabet="%()sdxf.0123456789*- a{}", max_size=12), st.sampled_from([1, "a", None]))
def test_any_template_ends(template, value):
    assert (
        len(av.text_with_holes(av.percent_format(av.Scalar(template), av.Scalar(value)))) < 100_000
    )


@pytest.mark.parametrize(
    ("name", "operand", "fake_study"),
    [
        ("-", av.Scalar(2), av.Scalar(-2)),
        ("+", av.Scalar(2.5), av.Scalar(2.5)),
        ("-", av.Choice((av.Scalar(1), av.Scalar(2))), av.Choice((av.Scalar(-1), av.Scalar(-2)))),
    ],
)
def test_unary(name, operand, fake_study):
    assert unary(name, operand) == fake_study


@pytest.mark.parametrize("operand", [HOLE, av.Scalar("a"), av.NONE, av.ListValue(), TEXT])
@pytest.mark.parametrize("name", ["-", "+", "~"])
def test_unary_of_what_is_no_number_is_a_hole(name, operand):
    assert isinstance(unary(name, operand), av.Unknown)
