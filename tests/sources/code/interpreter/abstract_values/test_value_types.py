"""Values known in part: joining, strings with holes, truth, at their bounds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.items import unpack
from rtron.sources.code.interpreter.abstract_values.value_types import MAX_CHOICES, MAX_PARTS

HOLE = av.Unknown("h")
TEXT = av.PartialText(("a", HOLE))
SOME = av.Choice((av.Scalar("a"), av.Scalar("b")))


def many(count):
    return [av.Scalar(str(number)) for number in range(count)]


def open_list(*items):
    return av.ListValue({"items": items, "open": True})


def test_join_of_nothing_is_none():
    assert av.join([]) == av.NONE


def test_join_flattens_and_drops_what_is_alike():
    assert av.join([SOME, av.Scalar("b"), av.Scalar("c")]) == av.Choice(
        (av.Scalar("a"), av.Scalar("b"), av.Scalar("c"))
    )
    assert av.join([av.Scalar("a"), av.Scalar("a")]) == av.Scalar("a")


def test_join_tells_what_python_calls_equal_apart_by_identity_of_objects():
    first, second = av.Instance(av.LibraryClass("k")), av.Instance(av.LibraryClass("k"))
    assert av.options(av.join([first, second, first])) == (first, second)


def test_join_holds_just_so_many_choices():
    assert len(av.options(av.join(many(MAX_CHOICES)))) == MAX_CHOICES
    assert isinstance(av.join(many(MAX_CHOICES + 1)), av.Unknown)


def test_a_known_and_a_hole_of_one_name_stay_two():
    assert av.join([av.Scalar("h"), HOLE]) == av.Choice((av.Scalar("h"), HOLE))


@given(st.lists(st.sampled_from([*many(4), HOLE, TEXT, SOME, av.NONE])))
def test_join_is_the_same_whatever_is_joined_first(values):
    half = len(values) // 2
    apart = [av.join(part) for part in (values[:half], values[half:]) if part]
    assert set(av.options(av.join(apart))) == set(av.options(av.join(values)))


@pytest.mark.parametrize(
    ("values", "whole"),
    [
        ([], ""),
        ([av.Scalar("")], ""),
        ([av.Scalar("a"), av.Scalar("b")], "ab"),
        ([av.Scalar("a"), av.Scalar(1), av.TRUE, av.NONE, av.Scalar(b"x")], "a1TrueNonex"),
        ([av.Scalar("a"), HOLE, av.Scalar("b"), av.Scalar("c")], "a{h}bc"),
        ([TEXT, TEXT], "a{h}a{h}"),
        ([HOLE], "{h}"),
        ([av.ListValue()], "{?}"),
    ],
)
def test_concat_spells_parts_in_order(values, whole):
    assert av.text_with_holes(av.concat(values)) == whole


def test_concat_is_known_where_every_part_is():
    assert av.concat([av.Scalar("a"), av.Scalar("b")]) == av.Scalar("ab")
    assert av.concat([av.Scalar(""), HOLE, av.Scalar("")]) == av.PartialText((HOLE,))
    assert av.concat([av.Scalar("a"), HOLE, av.Scalar("b"), av.Scalar("c")]).parts == (
        "a",
        HOLE,
        "bc",
    )


def test_concat_of_many_known_parts_is_whole_or_a_hole():
    whole = av.concat([av.Scalar("a")] * 10 * MAX_PARTS)
    assert isinstance(whole, (av.Unknown, av.PartialText)) or whole == av.Scalar(
        "a" * 10 * MAX_PARTS
    )


def test_concat_multiplies_options():
    assert av.options(av.concat([SOME, av.Scalar("/"), SOME])) == tuple(
        av.Scalar(f"{a}/{b}") for a in "ab" for b in "ab"
    )


def test_concat_of_many_options_stays_small():
    assert len(av.options(av.concat([SOME] * 30))) <= MAX_CHOICES


def test_concat_of_many_holes_stays_small():
    whole = av.concat([HOLE, av.Scalar("/")] * 100)
    assert isinstance(whole, (av.PartialText, av.Unknown))
    assert len(av.parts_of(whole)) <= MAX_PARTS


def test_concat_of_what_doubles_stays_small():
    value = av.Scalar("ab")
    for _ in range(18):
        value = av.concat([value, value])
    assert len(av.text_with_holes(value)) < 100_000


@pytest.mark.parametrize(
    ("value", "tainted"),
    [
        (av.Scalar("a"), False),
        (av.Scalar("a", tainted=True), True),
        (av.Unknown("a", tainted=True), True),
        (av.Choice((av.Scalar("a"), av.Scalar("b", tainted=True))), True),
        (SOME, False),
        (av.ListValue(), False),
    ],
)
def test_taint_shows(value, tainted):
    assert av.is_tainted(value) is tainted
    if not isinstance(value, av.ListValue):
        assert (
            any(av.is_tainted(o) for o in av.options(av.concat([av.Scalar("x"), value]))) is tainted
        )


@pytest.mark.parametrize(
    ("value", "counts"),
    [
        (av.NONE, False),
        (av.FALSE, False),
        (av.TRUE, True),
        (av.Scalar(0), False),
        (av.Scalar(""), False),
        (av.Scalar("0"), True),
        (HOLE, None),
        (av.ExternalSymbol("f"), None),
        (TEXT, True),
        (av.PartialText((HOLE,)), None),
        (av.PartialText(("", HOLE)), None),
        (SOME, True),
        (av.Choice((av.TRUE, av.FALSE)), None),
        (av.Choice((av.Scalar(0), av.Scalar(""))), False),
        (av.Choice((av.TRUE, HOLE)), None),
        (av.ListValue(), False),
        (av.list_of([av.FALSE]), True),
        (open_list(), None),
        (open_list(av.FALSE), True),
        (av.MapValue(), False),
        (av.MapValue({"a": av.FALSE}), True),
        (av.MapValue({av.OPEN: HOLE}), None),
        (av.Instance(av.LibraryClass("k")), None),
        (av.Instance(av.LibraryClass("k"), {"truth": av.TRUE}), True),
        (av.Instance(av.LibraryClass("k"), {"truth": av.FALSE}), False),
    ],
)
def test_truth_is_decided_only_where_it_is_known(value, counts):
    assert av.truth(value) is counts


def test_each_maps_every_option():
    assert av.map_options(SOME, lambda one: av.Scalar(one.value * 2)) == av.Choice(
        (av.Scalar("aa"), av.Scalar("bb"))
    )
    assert av.map_options(SOME, lambda one: av.NONE) == av.NONE
    assert av.map_options(HOLE, lambda one: one) is HOLE


@pytest.mark.parametrize(
    ("value", "items", "certain"),
    [
        (av.list_of([av.TRUE, av.FALSE]), (av.TRUE, av.FALSE), True),
        (av.ListValue(), (), True),
        (open_list(av.TRUE), (av.TRUE,), False),
        (av.MapValue({"a": av.TRUE}), (av.Scalar("a"),), True),
        (av.MapValue({"a": av.TRUE, av.OPEN: HOLE}), (av.Scalar("a"),), False),
        (av.Scalar("ab"), (av.Scalar("a"), av.Scalar("b")), True),
        (av.Scalar("", tainted=True), (), True),
        (av.NONE, (), True),
        (av.Scalar(5), (), False),
        (HOLE, (), False),
        (TEXT, (), False),
        (av.Choice((av.list_of([av.TRUE]), av.list_of([av.FALSE]))), (av.TRUE, av.FALSE), False),
    ],
)
def test_items_and_whether_they_are_all(value, items, certain):
    assert av.items_of(value) == (items, certain)


def test_the_items_of_a_map_of_cpp_are_pairs():
    (item,), certain = av.items_of(av.MapValue({"a": av.TRUE}, iterates_pairs=True))
    assert certain
    assert (item.fields["first"], item.fields["second"]) == (av.Scalar("a"), av.TRUE)


@pytest.mark.parametrize(
    ("value", "count", "parts"),
    [
        (av.list_of([av.TRUE, av.FALSE]), 2, (av.TRUE, av.FALSE)),
        (av.list_of([av.TRUE]), 2, (av.Unknown("?"), av.Unknown("?"))),
        (av.list_of([]), 0, ()),
        (open_list(av.TRUE), 1, (av.Unknown("?"),)),
        (HOLE, 2, (HOLE, HOLE)),
        (av.pair_of(av.TRUE, av.NONE), 2, (av.TRUE, av.NONE)),
        (av.Scalar("ab"), 2, (av.Scalar("a"), av.Scalar("b"))),
    ],
)
def test_unpacking_gives_just_so_many_values(value, count, parts):
    assert unpack(value, count) == parts


THREE = av.list_of([av.Scalar("a"), av.Scalar("b"), av.Scalar("c")])
TABLE = av.MapValue({"k": av.TRUE, 1: av.FALSE})


@pytest.mark.parametrize(
    ("owner", "key", "fake_study"),
    [
        (THREE, av.Scalar(0), av.Scalar("a")),
        (THREE, av.Scalar(2), av.Scalar("c")),
        (THREE, av.Scalar(-1), av.Scalar("c")),
        (THREE, av.Scalar(-3), av.Scalar("a")),
        (THREE, HOLE, av.Choice((av.Scalar("a"), av.Scalar("b"), av.Scalar("c")))),
        (TABLE, av.Scalar("k"), av.TRUE),
        (TABLE, av.Scalar(1), av.FALSE),
        (TABLE, HOLE, av.Choice((av.TRUE, av.FALSE))),
        (av.MapValue({av.OPEN: av.TRUE}), av.Scalar("x"), av.TRUE),
        (av.Scalar("abc"), av.Scalar(1), av.Scalar("b")),
        (av.Scalar("abc"), av.Scalar(-3), av.Scalar("a")),
    ],
)
def test_an_element_that_is_there(owner, key, fake_study):
    assert av.element(owner, key) == fake_study


@pytest.mark.parametrize(
    ("owner", "key"),
    [
        (THREE, av.Scalar(3)),
        (THREE, av.Scalar(-4)),
        (THREE, av.Scalar(10**30)),
        (av.ListValue(), HOLE),
        (av.ListValue(), av.Scalar(0)),
        (av.MapValue(), HOLE),
        (TABLE, av.Scalar("x")),
        (HOLE, av.Scalar(0)),
        (av.NONE, av.Scalar(0)),
        (av.Scalar("abc"), av.Scalar(3)),
    ],
)
def test_an_element_that_is_not_there_is_a_hole(owner, key):
    assert isinstance(av.element(owner, key), av.Unknown)
