import pytest
from store_data import SECOND, make_event, new_robot, store_events

from rtron.service.store.time_series import MAX_NAMES, MAX_POINTS, robot_time_series
from rtron.vocabulary import EventKind


def counts(second, values, run="run"):
    return make_event(second + 1, run=run, at=second * SECOND, kind=EventKind.COUNTS, values=values)


def of(flows, **values):
    return {"streams": {"/cmd_vel": {"flows": flows, **values}}, "fps": {}}


def read(database, since, until):
    with database.session() as session:
        return robot_time_series(session, "robot", since * SECOND, until * SECOND)


def test_each_second_is_a_point_while_there_is_place(database):
    robot = new_robot(database)
    store_events(
        database, robot, [counts(s, of({"flow1": [s, 0, 1, 0]})) for s in range(MAX_POINTS + 1)]
    )
    found = read(database, 0, MAX_POINTS)
    assert (found.width, found.every, len(found.points)) == (SECOND, 1, MAX_POINTS)
    assert found.points[7].at == 7 * SECOND
    assert found.points[7].streams["/cmd_vel"].flows == {"flow1": (7, 0, 1, 0)}


def test_points_that_share_a_place_are_merged(database):
    robot = new_robot(database)
    low = of({"a": [1, 2, 3, 4]}, speed=0.2, limit=0.5, latency=[10, 50]) | {"fps": {"m": 15}}
    high = of({"a": [1, 1, 1, 1], "b": [9, 0, 0, 0]}, speed=0.4, latency=[20, 40])
    store_events(database, robot, [counts(10, low), counts(11, high | {"fps": {"m": 5, "n": 1}})])
    found = read(database, 0, 2 * MAX_POINTS)
    assert (found.width, len(found.points)) == (2 * SECOND, 1)
    stream = found.points[0].streams["/cmd_vel"]
    assert stream.flows == {"a": (2, 3, 4, 5), "b": (9, 0, 0, 0)}
    assert (stream.speed, stream.limit, stream.latency) == (0.4, 0.5, (15, 50))
    assert found.points[0].fps == {"m": 5, "n": 1}


def test_never_more_points_than_most_and_long_times_are_sampled(database):
    robot = new_robot(database)
    hours = range(0, 48 * 3600, 7)
    for first in range(0, len(hours), 5000):
        some = hours[first : first + 5000]
        store_events(database, robot, [counts(second, of({"a": [1, 0, 0, 0]})) for second in some])
    found = read(database, 0, 48 * 3600)
    assert len(found.points) <= MAX_POINTS
    assert found.every == 15
    total = sum(point.streams["/cmd_vel"].flows["a"][0] for point in found.points)
    assert total == pytest.approx(len(hours), rel=0.05)


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"streams": []},
        {"streams": {"/cmd_vel": {"flows": {"a": [1, 2, 3]}}}},
        {"streams": {"/cmd_vel": {"flows": {"a": ["x", 2, 3, 4]}}}},
        {"streams": {}, "fps": {"m": "fast"}},
        {"left_out": 100_000},
    ],
)
def test_what_is_malformed_is_left_out(database, values):
    robot = new_robot(database)
    store_events(database, robot, [counts(1, values), counts(2, of({"a": [1, 0, 0, 0]}))])
    assert [point.at for point in read(database, 0, 10).points] == [2 * SECOND]


def test_names_are_bounded(database):
    robot = new_robot(database)
    values = {"streams": {f"/t{n}": {"flows": {}} for n in range(MAX_NAMES + 5)}, "fps": {}}
    store_events(database, robot, [counts(1, values)])
    assert len(read(database, 0, 10).points[0].streams) == MAX_NAMES


def test_bounds_of_the_time(database):
    robot = new_robot(database)
    store_events(database, robot, [counts(s, of({"a": [1, 0, 0, 0]})) for s in (4, 5, 9, 10)])
    assert [point.at // SECOND for point in read(database, 5, 10).points] == [5, 9]
    assert read(database, 5, 5).points == []
    assert read(database, 9, 5).points == []


def test_other_robots_and_kinds_do_not_count(database):
    new_robot(database)
    other = new_robot(database, "other")
    store_events(database, other, [counts(1, of({"a": [1, 0, 0, 0]}))], robot="other")
    assert read(database, 0, 10).points == []
