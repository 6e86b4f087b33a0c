"""What the camera and the laser scanner see."""

from math import pi

import numpy as np
import pytest

from rtron.demos.world import camera, ray_casting
from rtron.demos.world.ray_casting import scene_surfaces
from rtron.demos.world.robot_base import PEDESTRIAN_RADIUS
from rtron.demos.world.scenes.scene import PolygonObstacle, RoundObstacle, Scene, room_walls

ROOM = (6.0, 3.0)
EYE = (1.0, 1.5, 0.0)


def scene(*obstacles):
    return Scene(
        case="gr", seed=0, size=ROOM, walls=room_walls(*ROOM), obstacles=obstacles,
        start=EYE, goal=(5.0, 1.5), route=((1.0, 1.5), (5.0, 1.5)),
    )  # fmt: skip


def rendered(*obstacles, pose=EYE, people=(), lamp=None):
    return camera.render_image(scene_surfaces(scene(*obstacles)), 4, pose, people, lamp)


def pixels_of(image, colour):
    """Return the rows and columns of a colour."""
    return np.nonzero((image == colour).all(axis=2))


def scanned(*obstacles, pose=EYE, people=()):
    everything = scene_surfaces(scene(*obstacles)).with_discs(people, PEDESTRIAN_RADIUS)
    return np.frombuffer(ray_casting.scan(everything, pose), dtype="<f4")


def test_an_empty_room_is_grey():
    image = rendered(RoundObstacle((3.0, 1.0), 0.2))
    assert image.shape == (240, 320, 3)
    assert image.dtype == np.uint8
    assert (image == image[..., :1]).all()
    assert len(np.unique(image)) >= 4


@pytest.mark.parametrize("distance", [0.6, 1.0, 2.0])
def test_a_pedestrian_ahead_is_magenta_and_as_wide_as_documented(distance):
    rows, columns = pixels_of(rendered(people=[(1.0 + distance, 1.5)]), camera.PEDESTRIAN)
    assert abs(columns.mean() - 159.5) < 1
    width = columns.max() - columns.min() + 1
    assert width == pytest.approx(90 / distance, rel=0.06)
    assert rows.max() == pytest.approx(120 + 40 / (distance - PEDESTRIAN_RADIUS), abs=2)


@pytest.mark.parametrize(("y", "left"), [(1.8, True), (1.2, False)])
def test_what_is_on_the_left_is_left_in_the_image(y, left):
    _, columns = pixels_of(rendered(people=[(2.0, y)]), camera.PEDESTRIAN)
    assert (columns.mean() < 160) == left


def test_a_turned_robot_sees_what_is_there():
    image = rendered(pose=(3.0, 1.5, pi), people=[(2.0, 1.5)])
    assert abs(pixels_of(image, camera.PEDESTRIAN)[1].mean() - 159.5) < 1
    assert not len(
        pixels_of(rendered(pose=(3.0, 1.5, 0.0), people=[(2.0, 1.5)]), camera.PEDESTRIAN)[0]
    )


def test_who_is_behind_a_block_or_a_wall_is_not_seen():
    block = PolygonObstacle(((2.0, 1.0), (2.2, 1.0), (2.2, 2.0), (2.0, 2.0)))
    assert not len(pixels_of(rendered(block, people=[(3.0, 1.5)]), camera.PEDESTRIAN)[0])
    assert not len(pixels_of(rendered(people=[(3.0, 3.3)]), camera.PEDESTRIAN)[0])


@pytest.mark.parametrize(("state", "colour"), [("red", camera.RED), ("green", camera.GREEN)])
@pytest.mark.parametrize("distance", [0.8, 1.5])
def test_the_lamp_has_its_colour_place_and_size(state, colour, distance):
    place = (1.0 + distance, 1.5 + 0.3)
    image = rendered(RoundObstacle(place, 0.05), lamp=(place, state))
    rows, columns = pixels_of(image, colour)
    assert columns.mean() == pytest.approx(159.5 - camera.FOCAL * 0.3 / distance, abs=1)
    assert rows.mean() == pytest.approx(120 - 53 / distance, abs=1.5)
    assert len(rows) == pytest.approx(pi / 4 * (37 / distance) ** 2, rel=0.1)
    other = camera.GREEN if state == "red" else camera.RED
    assert not len(pixels_of(image, other)[0])


def test_a_turned_robot_sees_the_lamp_where_it_is():
    image = rendered(pose=(3.0, 1.0, pi / 2), lamp=((2.7, 2.0), "red"))
    columns = pixels_of(image, camera.RED)[1]
    assert columns.mean() == pytest.approx(159.5 - camera.FOCAL * 0.3, abs=1)


def test_a_block_hides_nothing_beside_it():
    block = PolygonObstacle(((2.0, 2.0), (2.2, 2.0), (2.2, 2.5), (2.0, 2.5)))
    for y in (1.5, 2.9):
        ranges = scanned(block, pose=(3.4, y, pi))
        assert ranges[0] == pytest.approx(3.4)


def test_a_lamp_behind_the_robot_or_a_pedestrian_is_not_seen():
    assert not len(pixels_of(rendered(lamp=((0.5, 1.5), "red")), camera.RED)[0])
    image = rendered(people=[(2.0, 1.5)], lamp=((3.0, 1.5), "red"))
    assert not len(pixels_of(image, camera.RED)[0])


def test_the_scanner_measures_walls_all_around_counter_clockwise():
    ranges = scanned(pose=(3.0, 1.0, 0.0))
    assert ranges.shape == (360,)
    assert ranges[[0, 90, 180, 270]] == pytest.approx([3.0, 2.0, 3.0, 1.0])
    turned = scanned(pose=(3.0, 1.0, pi / 2))
    assert turned[[0, 90, 180, 270]] == pytest.approx([2.0, 3.0, 1.0, 3.0])


def test_the_scanner_sees_discs_blocks_and_people():
    block = PolygonObstacle(((0.0, 1.0), (0.5, 1.0), (0.5, 2.0), (0.0, 2.0)))
    ranges = scanned(RoundObstacle((2.0, 1.5), 0.2), block, people=[(1.0, 2.5)])
    assert ranges[[0, 90, 180]] == pytest.approx([0.8, 1.0 - PEDESTRIAN_RADIUS, 0.5])


def test_the_scanner_has_limits():
    assert np.isinf(scanned()[0])
    assert scanned(RoundObstacle((1.15, 1.5), 0.1))[0] == pytest.approx(0.12)
