import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from rtron.reports.app.contention import MOST_ROWS, TopicFlow, draw_topic_flow
from rtron.reports.text_layout import TextPage

names = st.lists(st.text(st.characters(exclude_characters="►"), max_size=20), max_size=MOST_ROWS)


def drawn(publishers, successors, topic="/t", page=TextPage(), **keys):  # noqa: B008 - frozen
    flow = TopicFlow(tuple(publishers), topic, tuple(successors))
    return [row.plain for row in draw_topic_flow(flow, page, **keys)]


@pytest.mark.parametrize(
    ("publishers", "successors", "rows"),
    [
        ("a", "x", ["a ───► /t ───► x"]),
        ("ab", "x", ["a ─┬─► /t ───► x", "b ─┘"]),
        ("abc", "x", ["a ─┐", "b ─┼─► /t ───► x", "c ─┘"]),
        ("ab", "xy", ["a ─┬─► /t ─┬─► x", "b ─┘       └─► y"]),
        ("a", "xyz", ["           ┌─► x", "a ───► /t ─┼─► y", "           └─► z"]),
        ("abcd", "x", ["a ─┐", "b ─┼─► /t ───► x", "c ─┤", "d ─┘"]),
        (["long", "b"], "x", ["long ─┬─► /t ───► x", "b ────┘"]),
        ("ab", "", ["a ─┬─► /t", "b ─┘"]),
        ("", "", ["/t"]),
    ],
)
def test_side_by_side(publishers, successors, rows):
    assert drawn(publishers, successors) == rows


def test_one_below_another_where_the_page_is_too_narrow():
    needed = len("a ─┬─► /t ───► x")
    assert len(drawn("ab", "x", page=TextPage(needed))) == 2
    assert drawn("ab", "x", page=TextPage(needed - 1)) == [
        "/t",
        "  from  a",
        "        b",
        "  to    x",
    ]


def test_an_indent_takes_its_part_of_the_page():
    needed = len("a ─┬─► /t ───► x")
    assert drawn("ab", "x", page=TextPage(needed + 2), indent=2)[1] == "  b ─┘"
    assert drawn("ab", "x", page=TextPage(needed + 1), indent=2)[1] == "    from  a"


def test_wide_characters_stay_in_line():
    first, second = drawn(["机器人", "b"], "x")
    assert cell_len(first.partition("┬")[0]) == cell_len(second.partition("┘")[0])


def test_in_ascii_where_the_page_takes_no_more():
    rows = drawn("abc", "xy", page=TextPage(ascii_only=True))
    assert rows == ["a -+", "b -+-> /t -+-> x", "c -+       +-> y"]


def test_many_names_are_cut_short_and_counted():
    rows = drawn([f"n{i}" for i in range(MOST_ROWS + 1)], "x")
    assert len(rows) == MOST_ROWS
    assert rows[-1].startswith("… 2 more")
    assert len(drawn([f"n{i}" for i in range(MOST_ROWS)], "x")) == MOST_ROWS
    assert not any("more" in row for row in drawn([f"n{i}" for i in range(MOST_ROWS)], "x"))


@given(names, names, st.integers(1, 200))
def test_it_fits_wherever_it_stands_side_by_side(publishers, successors, width):
    rows = drawn(publishers, successors, page=TextPage(width))
    side_by_side = any("►" in row for row in rows)
    assert not side_by_side or max(map(cell_len, rows)) <= width
