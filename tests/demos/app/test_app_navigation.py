"""How the demo's robot finds its way and follows it."""

import json
from dataclasses import replace
from itertools import pairwise
from math import cos, dist, hypot, inf, nan, pi, sin

import pytest
from shapely import Point

from rtron.demos.apps.logic.demo_logic.geometry import heading, quaternion, wrap_angle
from rtron.demos.apps.logic.demo_logic.navigation import (
    MAX_TURN,
    REACHED,
    Navigator,
    Tracker,
    reachable,
)
from rtron.demos.apps.logic.demo_logic.path_planning import (
    ROBOT_RADIUS,
    SPACING,
    Grid,
    load_grid,
    plan,
)
from rtron.demos.apps.logic.demo_logic.perception import CRUISE, PEDESTRIAN, Detection
from rtron.demos.world.scenes.geometry import clearance_map, solid_area
from rtron.demos.world.scenes.scene import PolygonObstacle, RoundObstacle, Scene, room_walls

ROOM = Scene(
    case="gr",
    seed=0,
    size=(4.0, 3.0),
    walls=room_walls(4.0, 3.0),
    obstacles=(
        RoundObstacle((2.0, 1.5), 0.3),
        PolygonObstacle(((2.8, 0.0), (3.1, 0.0), (3.1, 1.0), (2.8, 1.0))),
    ),
    start=(0.5, 1.5, 0.0),
    goal=(3.5, 0.5),
    route=(),
)


def clearance(point):
    return solid_area(ROOM).distance(Point(point))


@pytest.fixture
def grid_of(tmp_path):
    def grid_of(scene):
        (tmp_path / "map.json").write_text(json.dumps(clearance_map(scene)))
        return load_grid(tmp_path / "map.json")

    return grid_of


@pytest.fixture
def room(grid_of):
    return grid_of(ROOM)


def near(detection=0.3, bearing=0.0, kind=PEDESTRIAN):
    return [Detection(kind, detection, bearing)]


@pytest.mark.parametrize(("angle", "same"), [(0, 0), (3 * pi, pi), (-pi, pi), (-3.5, 2 * pi - 3.5)])
def test_an_angle_is_brought_into_one_turn(angle, same):
    assert wrap_angle(angle) == pytest.approx(same)


@pytest.mark.parametrize("angle", [0.0, 0.4, -2.0, pi])
def test_a_heading_survives_its_quaternion(angle):
    assert heading(*quaternion(angle)) == pytest.approx(angle)


def test_outside_of_the_grid_nothing_is_free(room):
    assert room.clearance((-1, 0)) == room.clearance((room.columns, 0)) == -1.0
    assert room.clearance((0, 0)) >= 0


def test_the_route_keeps_clear_of_everything(room):
    route = plan(room, (0.5, 1.5), (3.5, 0.5))
    assert route[0] == (0.5, 1.5)
    assert route[-1] == (3.5, 0.5)
    assert min(map(clearance, route)) > ROBOT_RADIUS + 0.02
    assert max(dist(a, b) for a, b in pairwise(route)) <= SPACING + 1e-9


def test_a_free_line_is_the_route(room):
    length = sum(dist(a, b) for a, b in pairwise(plan(room, (0.5, 0.5), (2.0, 0.6))))
    assert length == pytest.approx(hypot(1.5, 0.1))


def test_a_goal_in_an_obstacle_is_replaced_by_a_free_place_near_it(room):
    end = plan(room, (0.5, 1.5), (2.0, 1.5))[-1]
    assert clearance(end) >= ROBOT_RADIUS
    assert dist(end, (2.0, 1.5)) < 0.8


def test_no_way_is_told(grid_of):
    walls = (*ROOM.walls, (1.5, 0, 1.5, 3))
    assert plan(grid_of(replace(ROOM, walls=walls)), (0.5, 1.5), (3.5, 0.5)) is None


def test_a_narrow_gap_is_taken_if_there_is_no_other(grid_of):
    walls = (*ROOM.walls, (1.2, 0, 1.2, 1.3), (1.2, 1.68, 1.2, 3))
    assert plan(grid_of(replace(ROOM, walls=walls, obstacles=())), (0.5, 0.5), (3.5, 0.5))


def test_a_velocity_is_reached_step_by_step():
    assert reachable((2.0, 1.0), (0.0, 0.0)) == pytest.approx((0.1, 0.07))
    assert reachable((0.1, -0.02), (0.0, 0.0)) == pytest.approx((0.1, -0.02))
    assert reachable((0.0, 0.0), (1.0, -1.0)) == pytest.approx((0.9, -0.93))


@pytest.mark.parametrize(("left", "reached"), [(REACHED, True), (REACHED + 0.01, False)])
def test_the_goal_is_reached_within_a_distance(left, reached):
    tracker = Tracker([(0.0, 0.0), (1.0, 0.0)])
    velocity = tracker.velocity((1.0 - left, 0.0, 0.0), (0.2, 0.0), 0.22)
    assert (velocity is None) == reached


@pytest.mark.parametrize(("behind", "sign"), [(2.0, 1), (-2.0, -1)])
def test_with_the_goal_behind_it_turns_to_the_shorter_side(behind, sign):
    velocity = Tracker([(0.0, 0.0), (1.0, 0.0)]).velocity((0.0, 0.0, -behind), (0.2, 0.0), 0.22)
    assert velocity[1] * sign > 0
    assert abs(velocity[1]) <= MAX_TURN


def drive_navigator(navigator, pose, seconds, limit=None):
    """Drive at once as told; return the poses and velocities, one for each 0.1 s."""
    found, velocity = [], (0.0, 0.0)
    for _ in range(int(seconds * 10)):
        navigator.set_odometry(pose, velocity)
        if limit is not None:
            navigator.set_max_velocity(limit)
        velocity = navigator.command() or (0.0, 0.0)
        x, y, turn = pose
        pose = (
            x + 0.1 * velocity[0] * cos(turn),
            y + 0.1 * velocity[0] * sin(turn),
            turn + 0.1 * velocity[1],
        )
        found.append((pose, velocity))
    return found


def navigator_with_goal(room):
    navigator = Navigator()
    navigator.set_odometry((0.5, 1.5, 0.0), (0.0, 0.0))
    assert navigator.set_goal((3.5, 0.6), room)
    return navigator


@pytest.mark.parametrize("turn", [0.0, 1.0, -1.0, 2.0])
def test_the_robot_comes_to_its_goal_and_touches_nothing(room, turn):
    way = drive_navigator(navigator_with_goal(room), (0.5, 1.5, turn), 30)
    assert dist(way[-1][0][:2], (3.5, 0.6)) <= REACHED
    assert min(clearance(pose[:2]) for pose, _ in way) > ROBOT_RADIUS
    assert max(velocity for _, (velocity, _) in way) <= CRUISE + 1e-9


def test_at_the_goal_it_says_zero_a_few_times_and_is_silent(room):
    navigator = navigator_with_goal(room)
    navigator.set_odometry((3.5, 0.6, 0.0), (0.2, 0.0))
    said = [navigator.command() for _ in range(7)]
    assert said == [(0.0, 0.0)] * 5 + [None] * 2


def test_without_a_goal_it_is_silent():
    navigator = Navigator()
    navigator.set_odometry((0.0, 0.0, 0.0), (0.0, 0.0))
    assert navigator.command() is None


@pytest.mark.parametrize("goal", [(nan, 1.0), (1.0, inf)])
def test_a_goal_that_is_no_place_changes_nothing(room, goal):
    navigator = navigator_with_goal(room)
    assert not navigator.set_goal(goal, room)
    assert navigator.command() is not None


def test_without_odometry_there_is_no_way(room):
    assert not Navigator().set_goal((1.0, 1.0), room)


def test_a_higher_limit_makes_it_faster(room):
    assert (
        max(
            v
            for _, (v, _) in drive_navigator(
                navigator_with_goal(room), (0.5, 1.5, 0.0), 10, limit=2.0
            )
        )
        > 0.26
    )


@pytest.mark.parametrize("limit", [nan, inf, -0.1])
def test_a_limit_that_is_no_velocity_is_left_out(limit):
    navigator = Navigator()
    navigator.set_max_velocity(0.1)
    navigator.set_max_velocity(limit)
    assert navigator.max_velocity == 0.1


@pytest.mark.parametrize(("away", "kept"), [(0.49, True), (0.51, False)])
def test_a_robot_that_is_carried_away_forgets_its_goal_and_limit(room, away, kept):
    navigator = navigator_with_goal(room)
    navigator.set_max_velocity(2.0)
    navigator.set_odometry((0.5 + away, 1.5, 0.0), (0.0, 0.0))
    assert (navigator.command() != (0.0, 0.0)) == kept
    assert (navigator.max_velocity == 2.0) == kept


def test_three_images_in_a_row_stop_it_and_three_let_it_go_on(room):
    navigator = navigator_with_goal(room)
    navigator.set_detections(near())
    navigator.set_detections(near())
    navigator.set_detections([])
    navigator.set_detections(near())
    navigator.set_detections(near())
    assert navigator.command() != (0.0, 0.0)
    navigator.set_detections(near())
    assert navigator.command() == (0.0, 0.0)
    navigator.set_detections([])
    navigator.set_detections([])
    assert navigator.command() == (0.0, 0.0)
    navigator.set_detections([])
    assert navigator.command() != (0.0, 0.0)


@pytest.mark.parametrize(
    ("seen", "stops"),
    [
        (near(0.15), True),
        (near(0.149), False),
        (near(0.3, 0.4), True),
        (near(0.3, -0.41), False),
        (near(0.01, 0.5, "red_light"), True),
        (near(0.009, 0.0, "red_light"), False),
        (near(0.5, 0.0, "green_light"), False),
    ],
)
def test_what_stops_it(room, seen, stops):
    navigator = navigator_with_goal(room)
    for _ in range(3):
        navigator.set_detections(seen)
    assert (navigator.command() == (0.0, 0.0)) == stops


def test_even_for_people_it_brakes_no_harder_than_it_can(room):
    navigator = navigator_with_goal(room)
    navigator.set_odometry((0.6, 1.5, 0.0), (2.0, 0.0))
    for _ in range(3):
        navigator.set_detections(near())
    assert navigator.command() == pytest.approx((1.9, 0.0))


def test_a_grid_says_where_its_cells_are():
    grid = Grid(0.1, 2, (0.5, 0.2))
    assert grid.cell((0.05, 0.05)) == (0, 0)
    assert grid.center((1, 0)) == pytest.approx((0.15, 0.05))
    assert grid.nearest((5.0, 0.0), 0.3) == (0, 0)
    assert grid.nearest((5.0, 0.0), 0.6) is None
