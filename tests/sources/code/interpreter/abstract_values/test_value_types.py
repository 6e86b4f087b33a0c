"""Values known in part: joining, strings with holes, truth, at their bounds."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, listed, pair, unpacked
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    MAX_CHOICES,
    MAX_PARTS,
    NONE,
    OPEN,
    TRUE,
    Choice,
    Foreign,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    NativeClass,
    Text,
    concat,
    each,
    is_tainted,
    join,
    options,
    parts_of,
    spelled,
    truth,
)

HOLE = Hole("h")
TEXT = Text(("a", HOLE))
SOME = Choice((Known("a"), Known("b")))


def many(count):
    return [Known(str(number)) for number in range(count)]


def open_list(*items):
    return ListValue({"items": items, "open": True})


def test_join_of_nothing_is_none():
    assert join([]) == NONE


def test_join_flattens_and_drops_what_is_alike():
    assert join([SOME, Known("b"), Known("c")]) == Choice((Known("a"), Known("b"), Known("c")))
    assert join([Known("a"), Known("a")]) == Known("a")


def test_join_tells_what_python_calls_equal_apart_by_identity_of_objects():
    first, second = Instance(NativeClass("k")), Instance(NativeClass("k"))
    assert options(join([first, second, first])) == (first, second)


def test_join_holds_just_so_many_choices():
    assert len(options(join(many(MAX_CHOICES)))) == MAX_CHOICES
    assert isinstance(join(many(MAX_CHOICES + 1)), Hole)


def test_a_known_and_a_hole_of_one_name_stay_two():
    assert join([Known("h"), HOLE]) == Choice((Known("h"), HOLE))


@given(st.lists(st.sampled_from([*many(4), HOLE, TEXT, SOME, NONE])))
def test_join_is_the_same_whatever_is_joined_first(values):
    half = len(values) // 2
    apart = [join(part) for part in (values[:half], values[half:]) if part]
    assert set(options(join(apart))) == set(options(join(values)))


@pytest.mark.parametrize(
    ("values", "whole"),
    [
        ([], ""),
        ([Known("")], ""),
        ([Known("a"), Known("b")], "ab"),
        ([Known("a"), Known(1), TRUE, NONE, Known(b"x")], "a1TrueNonex"),
        ([Known("a"), HOLE, Known("b"), Known("c")], "a{h}bc"),
        ([TEXT, TEXT], "a{h}a{h}"),
        ([HOLE], "{h}"),
        ([ListValue()], "{?}"),
    ],
)
def test_concat_spells_parts_in_order(values, whole):
    assert spelled(concat(values)) == whole


def test_concat_is_known_where_every_part_is():
    assert concat([Known("a"), Known("b")]) == Known("ab")
    assert concat([Known(""), HOLE, Known("")]) == Text((HOLE,))
    assert concat([Known("a"), HOLE, Known("b"), Known("c")]).parts == ("a", HOLE, "bc")


def test_concat_of_many_known_parts_is_whole_or_a_hole():
    whole = concat([Known("a")] * 10 * MAX_PARTS)
    assert isinstance(whole, (Hole, Text)) or whole == Known("a" * 10 * MAX_PARTS)


def test_concat_multiplies_options():
    assert options(concat([SOME, Known("/"), SOME])) == tuple(
        Known(f"{a}/{b}") for a in "ab" for b in "ab"
    )


def test_concat_of_many_options_stays_small():
    assert len(options(concat([SOME] * 30))) <= MAX_CHOICES


def test_concat_of_many_holes_stays_small():
    whole = concat([HOLE, Known("/")] * 100)
    assert isinstance(whole, (Text, Hole))
    assert len(parts_of(whole)) <= MAX_PARTS


def test_concat_of_what_doubles_stays_small():
    value = Known("ab")
    for _ in range(18):
        value = concat([value, value])
    assert len(spelled(value)) < 100_000


@pytest.mark.parametrize(
    ("value", "tainted"),
    [
        (Known("a"), False),
        (Known("a", tainted=True), True),
        (Hole("a", tainted=True), True),
        (Choice((Known("a"), Known("b", tainted=True))), True),
        (SOME, False),
        (ListValue(), False),
    ],
)
def test_taint_shows(value, tainted):
    assert is_tainted(value) is tainted
    if not isinstance(value, ListValue):
        assert any(is_tainted(o) for o in options(concat([Known("x"), value]))) is tainted


@pytest.mark.parametrize(
    ("value", "counts"),
    [
        (NONE, False),
        (FALSE, False),
        (TRUE, True),
        (Known(0), False),
        (Known(""), False),
        (Known("0"), True),
        (HOLE, None),
        (Foreign("f"), None),
        (TEXT, True),
        (Text((HOLE,)), None),
        (Text(("", HOLE)), None),
        (SOME, True),
        (Choice((TRUE, FALSE)), None),
        (Choice((Known(0), Known(""))), False),
        (Choice((TRUE, HOLE)), None),
        (ListValue(), False),
        (listed([FALSE]), True),
        (open_list(), None),
        (open_list(FALSE), True),
        (MapValue(), False),
        (MapValue({"a": FALSE}), True),
        (MapValue({OPEN: HOLE}), None),
        (Instance(NativeClass("k")), None),
        (Instance(NativeClass("k"), {"truth": TRUE}), True),
        (Instance(NativeClass("k"), {"truth": FALSE}), False),
    ],
)
def test_truth_is_decided_only_where_it_is_known(value, counts):
    assert truth(value) is counts


def test_each_maps_every_option():
    assert each(SOME, lambda one: Known(one.value * 2)) == Choice((Known("aa"), Known("bb")))
    assert each(SOME, lambda one: NONE) == NONE
    assert each(HOLE, lambda one: one) is HOLE


@pytest.mark.parametrize(
    ("value", "items", "certain"),
    [
        (listed([TRUE, FALSE]), (TRUE, FALSE), True),
        (ListValue(), (), True),
        (open_list(TRUE), (TRUE,), False),
        (MapValue({"a": TRUE}), (Known("a"),), True),
        (MapValue({"a": TRUE, OPEN: HOLE}), (Known("a"),), False),
        (Known("ab"), (Known("a"), Known("b")), True),
        (Known("", tainted=True), (), True),
        (NONE, (), True),
        (Known(5), (), False),
        (HOLE, (), False),
        (TEXT, (), False),
        (Choice((listed([TRUE]), listed([FALSE]))), (TRUE, FALSE), False),
    ],
)
def test_items_and_whether_they_are_all(value, items, certain):
    assert items_of(value) == (items, certain)


def test_the_items_of_a_map_of_cpp_are_pairs():
    (item,), certain = items_of(MapValue({"a": TRUE}, pairs=True))
    assert certain
    assert (item.fields["first"], item.fields["second"]) == (Known("a"), TRUE)


@pytest.mark.parametrize(
    ("value", "count", "parts"),
    [
        (listed([TRUE, FALSE]), 2, (TRUE, FALSE)),
        (listed([TRUE]), 2, (Hole("?"), Hole("?"))),
        (listed([]), 0, ()),
        (open_list(TRUE), 1, (Hole("?"),)),
        (HOLE, 2, (HOLE, HOLE)),
        (pair(TRUE, NONE), 2, (TRUE, NONE)),
        (Known("ab"), 2, (Known("a"), Known("b"))),
    ],
)
def test_unpacking_gives_just_so_many_values(value, count, parts):
    assert unpacked(value, count) == parts


THREE = listed([Known("a"), Known("b"), Known("c")])
TABLE = MapValue({"k": TRUE, 1: FALSE})


@pytest.mark.parametrize(
    ("owner", "key", "found"),
    [
        (THREE, Known(0), Known("a")),
        (THREE, Known(2), Known("c")),
        (THREE, Known(-1), Known("c")),
        (THREE, Known(-3), Known("a")),
        (THREE, HOLE, Choice((Known("a"), Known("b"), Known("c")))),
        (TABLE, Known("k"), TRUE),
        (TABLE, Known(1), FALSE),
        (TABLE, HOLE, Choice((TRUE, FALSE))),
        (MapValue({OPEN: TRUE}), Known("x"), TRUE),
        (Known("abc"), Known(1), Known("b")),
        (Known("abc"), Known(-3), Known("a")),
    ],
)
def test_an_element_that_is_there(owner, key, found):
    assert element(owner, key) == found


@pytest.mark.parametrize(
    ("owner", "key"),
    [
        (THREE, Known(3)),
        (THREE, Known(-4)),
        (THREE, Known(10**30)),
        (ListValue(), HOLE),
        (ListValue(), Known(0)),
        (MapValue(), HOLE),
        (TABLE, Known("x")),
        (HOLE, Known(0)),
        (NONE, Known(0)),
        (Known("abc"), Known(3)),
    ],
)
def test_an_element_that_is_not_there_is_a_hole(owner, key):
    assert isinstance(element(owner, key), Hole)
