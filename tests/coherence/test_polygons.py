"""What is a polygon, and what only looks like one."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rtron.coherence.msrcn import MAX_CORNERS, polygon_problem
from rtron.vocabulary import Point


def misfit(*corners) -> str:
    return polygon_problem([Point(x=x, y=y) for x, y in corners])


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (1, 0), (0, 1)],
        [(0, 0), (0, 1), (1, 0)],
        [(0, 0), (1, 0), (2, 0), (2, 1), (0, 1)],
        [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)],
        [(0.1, 0.1), (0.2, 0.2), (0.3, 0.31)],
        [(1e8, 1e8), (1e8 - 1, 1e8), (1e8, 1e8 - 1)],
        [(0, 0), (0.002, 0), (0, 0.001)],
    ],
)
def test_an_area(corners):
    assert misfit(*corners) == ""


@pytest.mark.parametrize(
    ("corners", "fault"),
    [
        ([], "an area has 3 to 100 corners"),
        ([(0, 0), (1, 0)], "an area has 3 to 100 corners"),
        ([(0, 0), (1, 0), (0, 0)], "the last corner is the first one: leave it out"),
        ([(0, 0), (1, 0), (0, 1), (0, 0)], "the last corner is the first one: leave it out"),
        ([(0, 0), (1, 0), (1, 0), (0, 1)], "a corner stands there twice"),
        ([(0, 0), (1, 0), (1, 1e-9), (0, 1)], "a corner stands there twice"),
        ([(0, 0), (1, 0), (2, 0)], "the corners lie on one line"),
        ([(0.1, 0.1), (0.2, 0.2), (0.3, 0.3)], "the corners lie on one line"),
        ([(0, 0), (1, 1), (1, 0), (0, 1)], "the edges from corner 1 and from corner 3 cross"),
        ([(0, 0), (1, 1), (0, 1), (1, 0)], "the edges from corner 1 and from corner 3 cross"),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], "the edges from corner 1 and from corner 2 cross"),
        ([(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)], "the edges from corner 1 and from corner 3"),
        ([(1, 0), (2, 0), (2, 1), (3, 1), (3, 0)], "the edges from corner 1 and from corner 5"),
        ([(1, 0), (2, 1), (3, 0), (0, 0), (4, 0), (2, 3)], "the edges from corner 1 and"),
        ([(0, 0), (0.0019, 0), (0, 0.001)], "the area is smaller than a square millimetre"),
    ],
)
def test_what_is_no_area(corners, fault):
    assert misfit(*corners).startswith(fault)


def ring(corners: int, wobble=lambda _: 1.0):
    turn = 2 * math.pi / corners
    return [
        (wobble(i) * math.cos(turn * i), wobble(i) * math.sin(turn * i)) for i in range(corners)
    ]


def test_the_most_corners():
    assert misfit(*ring(MAX_CORNERS)) == ""
    assert misfit(*ring(MAX_CORNERS + 1)) == "an area has 3 to 100 corners"


stars = st.lists(st.floats(0.5, 100), min_size=3, max_size=20)


@given(stars, st.integers(0, 19), st.booleans())
def test_a_star_is_an_area_wherever_it_begins_and_either_way_round(radii, start, reverse):
    corners = ring(len(radii), radii.__getitem__)
    turned = corners[start % len(corners) :] + corners[: start % len(corners)]
    assert misfit(*(turned[::-1] if reverse else turned)) == ""


@given(stars, st.data())
def test_a_star_with_two_neighbours_swapped_crosses_itself_or_is_another_star(radii, data):
    assume(len(radii) >= 5)
    corners = ring(len(radii), lambda _: 2.0)
    place = data.draw(st.integers(0, len(corners) - 2))
    corners[place], corners[place + 1] = corners[place + 1], corners[place]
    assert "cross" in misfit(*corners)
