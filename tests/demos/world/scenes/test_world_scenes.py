"""The scenes of the case studies: drivable over all seeds, and with room for what happens."""

import heapq
from dataclasses import replace
from functools import cache
from math import cos, dist, hypot, pi, sin

import pytest
import shapely
from shapely import LineString, Point, Polygon, box

from rtron.demos.world.robot_base import PEDESTRIAN_RADIUS, RADIUS
from rtron.demos.world.scenes import generator as drawn
from rtron.demos.world.scenes.geometry import solid_area
from rtron.demos.world.scenes.scene import PolygonObstacle

SEEDS = range(50)
CASES = ("gr", "rsr", "msr", "agent")
WITH_AREA = ("msr", "agent")
CELL = 0.1
MARGIN = 0.05
STEPS = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j]
scenes = pytest.mark.parametrize("case", CASES)
make_scene = cache(drawn.make_scene)


@cache
def planned(scene, goal):
    """Return a shortest way on a grid whose obstacles are inflated, as the robot plans it."""
    columns, rows = (int(side / CELL) + 1 for side in scene.size)
    cells = [(i, j) for i in range(columns) for j in range(rows)]
    points = shapely.points([(i * CELL, j * CELL) for i, j in cells])
    far = shapely.distance(solid_area(scene), points)
    free = {cell for cell, clear in zip(cells, far, strict=True) if clear > RADIUS + MARGIN}
    begin, end = (tuple(round(x / CELL) for x in place) for place in (scene.start[:2], goal))
    before, cost, queue = {begin: None}, {begin: 0.0}, [(0.0, begin)]
    while queue:
        _, cell = heapq.heappop(queue)
        if cell == end:
            break
        for step in STEPS:
            other = (cell[0] + step[0], cell[1] + step[1])
            new = cost[cell] + hypot(*step)
            if other in free and new < cost.get(other, 1e9):
                cost[other], before[other] = new, cell
                heapq.heappush(queue, (new + dist(other, end), other))
    assert end in before, (scene.case, scene.seed)
    way = [end]
    while before[way[-1]]:
        way.append(before[way[-1]])
    return LineString([(i * CELL, j * CELL) for i, j in way])


@scenes
def test_the_right_way_has_room_on_both_sides(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        assert solid_area(scene).distance(LineString(scene.route)) > RADIUS + 0.2, seed


@scenes
def test_the_right_way_leads_from_the_start_to_the_goal(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        assert scene.route[0] == scene.start[:2]
        assert scene.route[-1] == scene.goal
        assert 3.5 <= LineString(scene.route).length <= 5.1
        first = scene.route[1][0] - scene.route[0][0]
        assert cos(scene.start[2]) * first > 0.9 * abs(first)


@scenes
def test_a_planner_finds_a_way_that_is_hardly_longer(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        assert planned(scene, scene.goal).length < 1.12 * LineString(scene.route).length, seed


@pytest.mark.parametrize("case", WITH_AREA)
def test_no_way_to_the_goal_touches_the_area(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        area = Polygon(scene.area)
        assert area.is_valid
        assert area.distance(LineString(scene.route)) > 0.6
        assert area.distance(planned(scene, scene.goal)) > 0.3, seed


@pytest.mark.parametrize("case", WITH_AREA)
def test_the_bad_goal_is_well_inside_the_area_and_can_be_reached(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        inside = Polygon(scene.area).exterior.distance(Point(scene.bad_goal))
        assert Polygon(scene.area).contains(Point(scene.bad_goal))
        assert inside > 0.25, seed
        assert planned(scene, scene.bad_goal).length < 4.5


@scenes
def test_all_is_inside_the_walls(case):
    for seed in SEEDS:
        scene = make_scene(case, seed)
        room = box(0, 0, *scene.size).buffer(0.001)
        for place in (scene.start[:2], scene.goal, *(scene.area or ()), *scene.route):
            assert room.contains(Point(place))
        for obstacle in scene.obstacles:
            if isinstance(obstacle, PolygonObstacle):
                assert room.contains(Polygon(obstacle.polygon))


def test_a_corridor_is_narrow_and_its_way_straight():
    widths = {make_scene("gr", seed).size[1] for seed in SEEDS}
    assert 1.0 <= min(widths) < max(widths) <= 1.3
    assert all(len(make_scene("gr", seed).route) == 2 for seed in SEEDS)


def test_pedestrians_come_from_behind_the_wall_into_the_way():
    for seed in SEEDS:
        scene = make_scene("rsr", seed)
        assert scene.crossings
        way = LineString(scene.route)
        for crossing in scene.crossings:
            outside = box(0, 0, *scene.size).distance(Point(crossing.start))
            assert outside > PEDESTRIAN_RADIUS
            assert way.distance(Point(crossing.stand)) < 0.01
            walk = LineString([crossing.start, crossing.stand])
            things = [o for o in scene.obstacles if isinstance(o, PolygonObstacle)]
            assert all(Polygon(o.polygon).distance(walk) > PEDESTRIAN_RADIUS for o in things)


def test_a_slow_robot_can_brake_for_a_pedestrian_and_a_fast_one_cannot():
    for seed in SEEDS:
        for crossing in make_scene("rsr", seed).crossings:
            room = crossing.trigger_distance - RADIUS - PEDESTRIAN_RADIUS
            seen = 3 * 0.1
            assert 0.22 * (seen + 0.5) + 0.22**2 / 2 / 2.5 < 0.4 * room
            assert 2.0 * seen + 2.0**2 / 2 / 2.5 > room
            in_the_way = dist(crossing.start, crossing.stand) - RADIUS - PEDESTRIAN_RADIUS
            assert 2.0 * in_the_way / crossing.pace < room
            assert 3.0 <= crossing.pause <= 5.0


def test_the_light_stands_before_the_first_pedestrian_and_in_sight():
    for seed in SEEDS:
        scene = make_scene("rsr", seed)
        way = LineString(scene.route)
        light = way.project(Point(scene.light))
        first = min(way.project(Point(each.stand)) for each in scene.crossings)
        assert 1.0 < light < first
        assert light / 0.22 < scene.green_after + 2.0
        view = LineString([way.interpolate(light - 0.9), scene.light])
        assert solid_area(scene).intersection(view).length < 0.1


@scenes
def test_a_seed_makes_one_scene_and_seeds_make_many(case):
    assert drawn.make_scene(case, 3) == make_scene(case, 3)
    assert len({replace(make_scene(case, seed), seed=0) for seed in SEEDS}) == len(SEEDS)
    headings = {round(abs(sin(make_scene(case, seed).start[2] / 2))) for seed in SEEDS}
    assert headings == {0, 1}


def test_headings_are_within_half_a_turn():
    for seed in SEEDS:
        assert -pi <= make_scene("rsr", seed).start[2] <= pi
