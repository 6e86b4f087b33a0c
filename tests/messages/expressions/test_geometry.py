"""Places: inside, on the edge and outside of an area; distances; frames and back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from message_samples import POSE, pose_stamped
from slow_geometry import TOLERANCE, Polygon, distance

from rtron.messages import DefinitionRegistry, Encoding, MessageEvaluator
from rtron.messages.expressions.geometry import planar_transform
from rtron.vocabulary import Area, Point, Transform

CORNERS = ((0, 0), (4, 0), (4, 4), (2, 1), (0, 4))
coordinates = st.floats(-1e3, 1e3)
places = st.tuples(coordinates, coordinates)


def polygon(*corners):
    return Polygon([Point(x=x, y=y) for x, y in corners])


NOTCHED = polygon(*CORNERS)


@pytest.mark.parametrize(
    ("place", "inside"),
    [
        ((1.0, 1.0), True),
        ((2.0, 0.5), True),
        ((2.0, 2.0), False),
        ((2.0, 1.0), True),
        ((2.0, 1.0 + 1e-6), False),
        ((0.0, 0.0), True),
        ((4.0, 4.0), True),
        ((0.0, 4.0), True),
        ((0.0, 2.0), True),
        ((4.0, 2.0), True),
        ((3.0, 0.0), True),
        ((3.0, 2.5), True),
        ((0.0 - TOLERANCE / 2, 2.0), True),
        ((0.0 - TOLERANCE * 2, 2.0), False),
        ((4.0 + TOLERANCE * 2, 2.0), False),
        ((3.0, -TOLERANCE * 2), False),
        ((-1.0, 0.0), False),
        ((5.0, 4.0), False),
        ((1e308, 1.0), False),
    ],
)
def test_inside(place, inside):
    assert NOTCHED.contains(place) is inside
    assert (NOTCHED.distance(place) == 0.0) is inside


@pytest.mark.parametrize("corners", [CORNERS, CORNERS[::-1], CORNERS[2:] + CORNERS[:2]])
@given(place=places)
def test_the_order_of_corners_does_not_count(corners, place):
    assert polygon(*corners).contains(place) is NOTCHED.contains(place)


@given(place=places, low=coordinates, width=st.floats(0.1, 100))
def test_rectangles(place, low, width):
    found = polygon((low, low), (low + width, low), (low + width, low + width), (low, low + width))
    away = [max(low - each, each - low - width, 0.0) for each in place]
    assert found.distance(place) == pytest.approx(math.hypot(*away), abs=2 * TOLERANCE)


@pytest.mark.parametrize(
    ("place", "away"),
    [((-3.0, -4.0), 5.0), ((2.0, -2.0), 2.0), ((6.0, 2.0), 2.0), ((2.0, 4.0), None)],
)
def test_distance_to_an_area(place, away):
    notch = 3 * 2 / math.hypot(2, 3)
    assert NOTCHED.distance(place) == pytest.approx(notch if away is None else away)


def test_degenerate_area():
    assert polygon((1, 1), (1, 1), (1, 1)).contains((1.0, 1.0))
    assert polygon((1, 1), (1, 1), (1, 1)).distance((4.0, 5.0)) == 5.0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_places_that_are_no_numbers(bad):
    for place in ((bad, 1.0), (1.0, bad)):
        for call in (NOTCHED.contains, NOTCHED.distance, lambda each: distance(each, (0.0, 0.0)),
                     lambda each: distance((0.0, 0.0), each)):  # fmt: skip
            with pytest.raises(ValueError, match="not finite"):
                call(place)


def test_distance():
    assert distance((1.0, 1.0), (4.0, 5.0)) == 5.0


@pytest.mark.parametrize(
    ("yaw", "expected"), [(0.0, (11.0, 20.0)), (math.pi / 2, (10.0, 21.0)), (math.pi, (9.0, 20.0))]
)
def test_first_turned_then_moved(yaw, expected):
    moved = planar_transform(Transform(source="a", target="b", x=10.0, y=20.0, yaw=yaw)).apply(
        1.0, 0.0
    )
    assert moved == pytest.approx(expected)


@given(place=places, x=coordinates, y=coordinates, yaw=st.floats(-7, 7))
def test_there_and_back(place, x, y, yaw):
    there = planar_transform(Transform(source="a", target="b", x=x, y=y, yaw=yaw))
    assert there.inverse().apply(*there.apply(*place)) == pytest.approx(place, abs=1e-8)
    assert there.apply(*there.inverse().apply(*place)) == pytest.approx(place, abs=1e-8)


@pytest.fixture(scope="module")
def judged():
    """Ask where a pose is, in CEL."""
    pytest.importorskip("cel_expr_python.cel", reason="no CEL on this machine")
    corners = tuple(Point(x=float(x), y=float(y)) for x, y in CORNERS)
    at = "event.pose.position"
    texts = [
        f"inside({at}, zone)",
        f"distance({at}, zone) == 0.0",
        *(f"distance({at}, zone) <= {limit}" for limit in LIMITS),
        *(f"distance({at}, place(1.0, 1.0)) <= {limit}" for limit in LIMITS),
    ]
    return MessageEvaluator(
        DefinitionRegistry().find(POSE), texts, subject="event", encoding=Encoding.ROS1,
        areas=[Area(name="zone", frame="map", polygon=corners)], frames=["map"] * len(texts),
    )  # fmt: skip


LIMITS = (0.5, 1.0, 3.0, 100.0)
near = st.one_of(
    st.floats(-1.0, 5.0),
    st.sampled_from([0.0, 1.0, 2.0, 4.0]),
    st.sampled_from([0.0, 1.0, 2.0, 4.0]).map(lambda x: x + TOLERANCE / 2),
    st.sampled_from([0.0, 1.0, 2.0, 4.0]).map(lambda x: x - TOLERANCE * 2),
    st.floats(allow_nan=False, allow_infinity=False),
)


@given(x=near, y=near)
def test_expressions_agree_with_the_plain_way(judged, x, y):
    found = judged.evaluate(pose_stamped(Encoding.ROS1, "map", x, y))
    inside, away = NOTCHED.contains((x, y)), NOTCHED.distance((x, y))
    assert found[:2] == (inside, inside)
    for said, limit in zip(found[2:6], LIMITS, strict=True):
        assert said is (away <= limit) or abs(away - limit) < 1e-9
    for said, limit in zip(found[6:], LIMITS, strict=True):
        assert said is (distance((x, y), (1.0, 1.0)) <= limit) or abs(away - limit) < 1e-9
