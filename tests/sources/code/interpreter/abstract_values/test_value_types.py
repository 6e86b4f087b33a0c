"""Values known in part: joining, strings with holes, truth, at their bounds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of, pair_of, unpack
from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    MAX_CHOICES,
    MAX_PARTS,
    NONE,
    OPEN,
    TRUE,
    Choice,
    ExternalSymbol,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    concat,
    is_tainted,
    join,
    map_options,
    options,
    parts_of,
    text_with_holes,
)

HOLE = Unknown("h")
TEXT = PartialText(("a", HOLE))
SOME = Choice((Scalar("a"), Scalar("b")))


def many(count):
    return [Scalar(str(number)) for number in range(count)]


def open_list(*items):
    return ListValue({"items": items, "open": True})


def test_join_of_nothing_is_none():
    assert join([]) == NONE


def test_join_flattens_and_drops_what_is_alike():
    assert join([SOME, Scalar("b"), Scalar("c")]) == Choice((Scalar("a"), Scalar("b"), Scalar("c")))
    assert join([Scalar("a"), Scalar("a")]) == Scalar("a")


def test_join_tells_what_python_calls_equal_apart_by_identity_of_objects():
    first, second = Instance(LibraryClass("k")), Instance(LibraryClass("k"))
    assert options(join([first, second, first])) == (first, second)


def test_join_holds_just_so_many_choices():
    assert len(options(join(many(MAX_CHOICES)))) == MAX_CHOICES
    assert isinstance(join(many(MAX_CHOICES + 1)), Unknown)


def test_a_known_and_a_hole_of_one_name_stay_two():
    assert join([Scalar("h"), HOLE]) == Choice((Scalar("h"), HOLE))


@given(st.lists(st.sampled_from([*many(4), HOLE, TEXT, SOME, NONE])))
def test_join_is_the_same_whatever_is_joined_first(values):
    half = len(values) // 2
    apart = [join(part) for part in (values[:half], values[half:]) if part]
    assert set(options(join(apart))) == set(options(join(values)))


@pytest.mark.parametrize(
    ("values", "whole"),
    [
        ([], ""),
        ([Scalar("")], ""),
        ([Scalar("a"), Scalar("b")], "ab"),
        ([Scalar("a"), Scalar(1), TRUE, NONE, Scalar(b"x")], "a1TrueNonex"),
        ([Scalar("a"), HOLE, Scalar("b"), Scalar("c")], "a{h}bc"),
        ([TEXT, TEXT], "a{h}a{h}"),
        ([HOLE], "{h}"),
        ([ListValue()], "{?}"),
    ],
)
def test_concat_spells_parts_in_order(values, whole):
    assert text_with_holes(concat(values)) == whole


def test_concat_is_known_where_every_part_is():
    assert concat([Scalar("a"), Scalar("b")]) == Scalar("ab")
    assert concat([Scalar(""), HOLE, Scalar("")]) == PartialText((HOLE,))
    assert concat([Scalar("a"), HOLE, Scalar("b"), Scalar("c")]).parts == ("a", HOLE, "bc")


def test_concat_of_many_known_parts_is_whole_or_a_hole():
    whole = concat([Scalar("a")] * 10 * MAX_PARTS)
    assert isinstance(whole, (Unknown, PartialText)) or whole == Scalar("a" * 10 * MAX_PARTS)


def test_concat_multiplies_options():
    assert options(concat([SOME, Scalar("/"), SOME])) == tuple(
        Scalar(f"{a}/{b}") for a in "ab" for b in "ab"
    )


def test_concat_of_many_options_stays_small():
    assert len(options(concat([SOME] * 30))) <= MAX_CHOICES


def test_concat_of_many_holes_stays_small():
    whole = concat([HOLE, Scalar("/")] * 100)
    assert isinstance(whole, (PartialText, Unknown))
    assert len(parts_of(whole)) <= MAX_PARTS


def test_concat_of_what_doubles_stays_small():
    value = Scalar("ab")
    for _ in range(18):
        value = concat([value, value])
    assert len(text_with_holes(value)) < 100_000


@pytest.mark.parametrize(
    ("value", "tainted"),
    [
        (Scalar("a"), False),
        (Scalar("a", tainted=True), True),
        (Unknown("a", tainted=True), True),
        (Choice((Scalar("a"), Scalar("b", tainted=True))), True),
        (SOME, False),
        (ListValue(), False),
    ],
)
def test_taint_shows(value, tainted):
    assert is_tainted(value) is tainted
    if not isinstance(value, ListValue):
        assert any(is_tainted(o) for o in options(concat([Scalar("x"), value]))) is tainted


@pytest.mark.parametrize(
    ("value", "counts"),
    [
        (NONE, False),
        (FALSE, False),
        (TRUE, True),
        (Scalar(0), False),
        (Scalar(""), False),
        (Scalar("0"), True),
        (HOLE, None),
        (ExternalSymbol("f"), None),
        (TEXT, True),
        (PartialText((HOLE,)), None),
        (PartialText(("", HOLE)), None),
        (SOME, True),
        (Choice((TRUE, FALSE)), None),
        (Choice((Scalar(0), Scalar(""))), False),
        (Choice((TRUE, HOLE)), None),
        (ListValue(), False),
        (list_of([FALSE]), True),
        (open_list(), None),
        (open_list(FALSE), True),
        (MapValue(), False),
        (MapValue({"a": FALSE}), True),
        (MapValue({OPEN: HOLE}), None),
        (Instance(LibraryClass("k")), None),
        (Instance(LibraryClass("k"), {"truth": TRUE}), True),
        (Instance(LibraryClass("k"), {"truth": FALSE}), False),
    ],
)
def test_truth_is_decided_only_where_it_is_known(value, counts):
    assert truth(value) is counts


def test_each_maps_every_option():
    assert map_options(SOME, lambda one: Scalar(one.value * 2)) == Choice(
        (Scalar("aa"), Scalar("bb"))
    )
    assert map_options(SOME, lambda one: NONE) == NONE
    assert map_options(HOLE, lambda one: one) is HOLE


@pytest.mark.parametrize(
    ("value", "items", "certain"),
    [
        (list_of([TRUE, FALSE]), (TRUE, FALSE), True),
        (ListValue(), (), True),
        (open_list(TRUE), (TRUE,), False),
        (MapValue({"a": TRUE}), (Scalar("a"),), True),
        (MapValue({"a": TRUE, OPEN: HOLE}), (Scalar("a"),), False),
        (Scalar("ab"), (Scalar("a"), Scalar("b")), True),
        (Scalar("", tainted=True), (), True),
        (NONE, (), True),
        (Scalar(5), (), False),
        (HOLE, (), False),
        (TEXT, (), False),
        (Choice((list_of([TRUE]), list_of([FALSE]))), (TRUE, FALSE), False),
    ],
)
def test_items_and_whether_they_are_all(value, items, certain):
    assert items_of(value) == (items, certain)


def test_the_items_of_a_map_of_cpp_are_pairs():
    (item,), certain = items_of(MapValue({"a": TRUE}, iterates_pairs=True))
    assert certain
    assert (item.fields["first"], item.fields["second"]) == (Scalar("a"), TRUE)


@pytest.mark.parametrize(
    ("value", "count", "parts"),
    [
        (list_of([TRUE, FALSE]), 2, (TRUE, FALSE)),
        (list_of([TRUE]), 2, (Unknown("?"), Unknown("?"))),
        (list_of([]), 0, ()),
        (open_list(TRUE), 1, (Unknown("?"),)),
        (HOLE, 2, (HOLE, HOLE)),
        (pair_of(TRUE, NONE), 2, (TRUE, NONE)),
        (Scalar("ab"), 2, (Scalar("a"), Scalar("b"))),
    ],
)
def test_unpacking_gives_just_so_many_values(value, count, parts):
    assert unpack(value, count) == parts


THREE = list_of([Scalar("a"), Scalar("b"), Scalar("c")])
TABLE = MapValue({"k": TRUE, 1: FALSE})


@pytest.mark.parametrize(
    ("owner", "key", "fake_study"),
    [
        (THREE, Scalar(0), Scalar("a")),
        (THREE, Scalar(2), Scalar("c")),
        (THREE, Scalar(-1), Scalar("c")),
        (THREE, Scalar(-3), Scalar("a")),
        (THREE, HOLE, Choice((Scalar("a"), Scalar("b"), Scalar("c")))),
        (TABLE, Scalar("k"), TRUE),
        (TABLE, Scalar(1), FALSE),
        (TABLE, HOLE, Choice((TRUE, FALSE))),
        (MapValue({OPEN: TRUE}), Scalar("x"), TRUE),
        (Scalar("abc"), Scalar(1), Scalar("b")),
        (Scalar("abc"), Scalar(-3), Scalar("a")),
    ],
)
def test_an_element_that_is_there(owner, key, fake_study):
    assert element(owner, key) == fake_study


@pytest.mark.parametrize(
    ("owner", "key"),
    [
        (THREE, Scalar(3)),
        (THREE, Scalar(-4)),
        (THREE, Scalar(10**30)),
        (ListValue(), HOLE),
        (ListValue(), Scalar(0)),
        (MapValue(), HOLE),
        (TABLE, Scalar("x")),
        (HOLE, Scalar(0)),
        (NONE, Scalar(0)),
        (Scalar("abc"), Scalar(3)),
    ],
)
def test_an_element_that_is_not_there_is_a_hole(owner, key):
    assert isinstance(element(owner, key), Unknown)
