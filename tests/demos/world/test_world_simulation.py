"""The world without sockets: motion, collisions, the area, people, light and battery."""

from itertools import pairwise
from math import atan2, cos, dist, pi

import pytest

from rtron.demos.world import robot_base, server
from rtron.demos.world.robot_base import VelocityCommand
from rtron.demos.world.simulation import RobotSimulation

CRUISE = 0.22


@pytest.fixture(scope="module")
def world():
    return RobotSimulation()


def start_run(world, case, seed=1):
    world.reset(case, seed)
    world.start()
    return world.scene


def drive(world, velocity, seconds):
    """Drive for some simulated seconds, and return the truth after each step."""
    found = []
    for _ in range(round(seconds / robot_base.STEP)):
        world.set_velocity(velocity, 0.0)
        world.step()
        found.append(world.truth())
    return found


def drive_to(world, place, speed, limit=60.0):
    """Drive straight to a place, and return the truth after each step."""
    found = []
    while not found or (
        dist(found[-1].pose[:2], place) > 0.1 and len(found) < limit / robot_base.STEP
    ):
        x, y, heading = world.motion()[0]
        off = (atan2(place[1] - y, place[0] - x) - heading + pi) % (2 * pi) - pi
        ahead = speed if abs(off) < 0.5 else 0.0
        found += drive(world, (ahead, 2 * off), robot_base.STEP)
    return found


def test_the_robot_accelerates_no_faster_than_its_motors_can(world):
    start_run(world, "gr")
    truths = drive(world, (9.0, 9.0), 0.6)
    before = (0.0, 0.0)
    for truth in truths:
        assert truth.velocity[0] - before[0] <= 2.5 * robot_base.STEP + 1e-9
        assert truth.velocity[1] - before[1] <= 6.0 * robot_base.STEP + 1e-9
        before = truth.velocity
    assert truths[0].velocity == pytest.approx((0.125, 0.3))
    assert before == pytest.approx((1.5, 2.84))
    assert truths[-1].commanded == (2.0, 2.84)


def test_the_motors_stop_when_nobody_has_told_them_anything_for_half_a_second(world):
    start_run(world, "gr")
    moving = drive(world, (CRUISE, 0.0), 1.0)[-1].velocity[0]
    speeds = []
    for _ in range(14):
        world.step()
        speeds.append(world.truth().velocity[0])
    assert speeds[:9] == pytest.approx([moving] * 9)
    assert speeds[9] < moving
    assert speeds[-1] == 0.0
    assert drive(world, (CRUISE, 0.0), 1.0)[-1].velocity[0] == pytest.approx(CRUISE)


def test_the_robot_goes_where_it_heads(world):
    scene = start_run(world, "gr")
    truths = drive(world, (CRUISE, 0.0), 4.0)
    gone = dist(truths[-1].pose[:2], scene.start[:2])
    assert gone == pytest.approx(4.0 * CRUISE, abs=0.02)
    assert truths[-1].distance_to_goal == pytest.approx(
        dist(scene.start[:2], scene.goal) - gone, 0.01
    )
    assert truths[-1].t - truths[0].t == pytest.approx(4.0 - robot_base.STEP)


def test_a_reset_begins_a_new_run_at_the_start_and_time_goes_on(world):
    start_run(world, "gr")
    before = drive(world, (CRUISE, 0.0), 1.0)[-1]
    world.reset("rsr", 2)
    after = world.truth()
    assert (after.run, after.t) == (before.run + 1, before.t)
    assert after.pose == pytest.approx(world.scene.start)
    assert after.velocity == after.commanded == (0.0, 0.0)


def test_the_brake_is_on_from_the_reset_to_the_start(world):
    world.reset("gr", 1)
    held = drive(world, (CRUISE, 0.0), 1.0)[-1]
    assert held.pose[:2] == pytest.approx(world.scene.start[:2])
    assert cos(held.pose[2] - world.scene.start[2]) == pytest.approx(1.0)
    world.start()
    assert drive(world, (CRUISE, 0.0), 1.0)[-1].velocity[0] == pytest.approx(CRUISE)


def test_a_collision_holds_the_robot_until_the_next_reset(world):
    start_run(world, "gr")
    drive(world, (0.0, 1.0), pi / 2)
    truths = drive(world, (CRUISE, 0.0), 4.0)
    hit = next(truth for truth in truths if truth.collided)
    assert hit.clearance == 0.0
    assert truths[truths.index(hit) - 1].clearance < 0.02
    assert truths[-1].collided
    assert drive(world, (-CRUISE, 0.0), 1.0)[-1].pose == pytest.approx(hit.pose)
    world.reset("gr", 1)
    assert not drive(world, (0.0, 0.0), 0.1)[-1].collided


def test_clearance_is_the_free_space_around_the_body(world):
    scene = start_run(world, "gr", 4)
    x, y, _ = scene.start
    walls = min(y, scene.size[1] - y, x, scene.size[0] - x)
    assert 0.1 < world.truth().clearance <= walls - robot_base.RADIUS + 1e-6


def test_the_area_stops_the_robot(world):
    scene = start_run(world, "msr")
    drive_to(world, scene.bad_goal, 0.5, limit=15)
    truth = drive(world, (0.5, 0.0), 1.0)[-1]
    assert truth.in_area
    assert not truth.collided
    assert truth.velocity == pytest.approx((0.0, 0.0))
    assert truth.commanded == (0.5, 0.0)
    world.reset("msr", 1)
    assert not world.truth().in_area


@pytest.mark.parametrize("seed", range(4))
def test_the_right_way_of_msr_leads_to_the_goal(world, seed):
    scene = start_run(world, "msr", seed)
    truths = [truth for place in scene.route[1:] for truth in drive_to(world, place, CRUISE)]
    assert truths[-1].distance_to_goal < 0.12
    assert not any(truth.in_area or truth.collided for truth in truths)
    assert 15 < truths[-1].t - truths[0].t < 30


@pytest.mark.parametrize("reaction", [0.4, 9.0])
@pytest.mark.parametrize("seed", range(8))
def test_a_fast_robot_hits_a_pedestrian_though_it_brakes(world, seed, reaction):
    scene = start_run(world, "rsr", seed)
    since, hit = 0.0, world.truth()
    while not hit.collided and hit.distance_to_goal > 0.1:
        since += robot_base.STEP if world.people else 0.0
        hit = drive_to(world, scene.goal, 2.0 if since < reaction else 0.0, robot_base.STEP)[-1]
    assert hit.collided
    assert min(dist(hit.pose[:2], place) for place in hit.pedestrians) < 0.3


def test_a_robot_that_stops_sees_the_pedestrian_come_stand_and_go(world):
    scene = start_run(world, "rsr", 1)
    crossing = scene.crossings[0]
    while not world.people:
        drive_to(world, scene.goal, CRUISE, limit=robot_base.STEP)
    truths = drive(world, (0.0, 0.0), crossing.pause + 3.0)
    present = [truth for truth in truths if truth.pedestrians]
    still = [a for a, b in pairwise(present) if a.pedestrians == b.pedestrians]
    assert len(still) * robot_base.STEP == pytest.approx(crossing.pause, abs=0.15)
    assert dist(still[0].pedestrians[0], still[0].pose[:2]) > 0.6
    assert min(truth.clearance for truth in truths) > 0.2
    assert not truths[-1].pedestrians
    assert not truths[-1].collided


def test_the_light_is_red_then_green(world):
    world.reset("rsr", 1)
    assert {truth.light for truth in drive(world, (0.0, 0.0), 12.0)} == {"red"}
    world.start()
    lights = [truth.light for truth in drive(world, (0.0, 0.0), 12.0)]
    changed = lights.index("green")
    assert set(lights[:changed]) == {"red"}
    assert set(lights[changed:]) == {"green"}
    assert changed * robot_base.STEP == pytest.approx(world.scene.green_after, abs=0.1)
    start_run(world, "gr")
    assert world.truth().light == "none"


def test_the_battery_empties_and_never_below_nothing():
    assert server.battery_percentage(0.0) == 1.0
    assert server.battery_percentage(4500.0) == pytest.approx(0.5)
    assert server.battery_percentage(1e6) == 0.0
    assert server.battery_voltage(1e6) == pytest.approx(11.1)


def test_who_sends_more_often_has_a_larger_share_of_a_step():
    command = VelocityCommand()
    assert command.end_step() == (0.0, 0.0)
    command.set_velocity((0.2, 0.0), 0.0)
    command.set_velocity((0.0, -0.2), 0.25)
    assert command.end_step() == pytest.approx((0.05, -0.15))
    assert command.end_step() == (0.0, -0.2)
    command.set_velocity((1.0, 0.0), 2.0)
    assert command.end_step() == pytest.approx((0.0, -0.2))
    assert command.end_step() == (1.0, 0.0)
