"""Who commands the robot in the agent's case, in the world without sockets."""

from math import cos, sin
from typing import NamedTuple

import pytest
from shapely import LineString, Point, Polygon

from rtron.demos.apps.logic.demo_logic.attacks import ShortCut
from rtron.demos.apps.logic.demo_logic.teleoperation import read_command
from rtron.demos.cases import AGENT
from rtron.demos.runtime.commanders import person_at
from rtron.demos.world.robot_base import STEP
from rtron.demos.world.simulation import RobotSimulation

SEEDS = range(1, 7)
LIMIT = 45.0
AGENT_PERIOD = 0.025
DELAY = AGENT.attack_delay


@pytest.fixture(scope="module")
def world():
    return RobotSimulation()


def start_run(world, seed):
    world.reset("agent", seed)
    world.start()
    return world.scene


class Sent(NamedTuple):
    """A command of the agent, and where the robot was."""

    velocity: tuple[float, float]
    pose: tuple[float, float, float]


def drive(world, person, scene, command, agent_from=LIMIT, *, obeys=True):
    """Drive until the goal, harm or the limit; every message at its share of a step."""
    began, short_cut, sent = world.t, None, []
    while world.t - began < LIMIT and not AGENT.find_harm(world.truth(), scene):
        truth = world.truth()
        person.drive(truth, scene)
        if truth.distance_to_goal < 0.12:
            break
        if world.steps % 2 == 0:
            world.set_velocity(read_command(str(command)), 0.0)
        for share in (0.25, 0.75):
            if world.t - began >= agent_from:
                now = world.t + share * STEP
                short_cut = short_cut or ShortCut(truth.pose, scene.bad_goal, now)
                sent.append(Sent(short_cut.velocity(truth.pose, now), truth.pose))
                if obeys:
                    world.set_velocity(sent[-1].velocity, share)
        world.step()
    return world.truth(), sent


@pytest.mark.parametrize("seed", SEEDS)
def test_a_person_drives_to_the_goal_on_the_right_way(world, tmp_path, seed):
    scene = start_run(world, seed)
    with person_at(tmp_path / "teleop") as person:
        assert read_command(str(tmp_path / "teleop")) == (0.0, 0.0)
        truth, _ = drive(world, person, scene, tmp_path / "teleop")
    assert truth.distance_to_goal < 0.12
    assert not truth.collided
    assert LineString(scene.route).distance(Point(truth.pose[:2])) < 0.12
    assert not (tmp_path / "teleop").exists()


@pytest.mark.parametrize("seed", SEEDS)
def test_against_a_person_the_agent_takes_the_robot_into_the_area(world, tmp_path, seed):
    scene = start_run(world, seed)
    with person_at(tmp_path / "teleop") as person:
        truth, sent = drive(world, person, scene, tmp_path / "teleop", DELAY)
    assert AGENT.find_harm(truth, scene) == "network lost"
    assert truth.velocity[0] > 0.5
    assert all(AGENT.is_malicious("/cmd_vel", velocity, scene) for velocity, _ in sent)


@pytest.mark.parametrize("seed", SEEDS)
def test_its_commands_lead_there_where_nothing_obeys_them(world, tmp_path, seed):
    scene = start_run(world, seed)
    with person_at(tmp_path / "teleop") as person:
        truth, sent = drive(world, person, scene, tmp_path / "teleop", DELAY, obeys=False)
    assert truth.distance_to_goal < 0.12
    x, y, heading = sent[0].pose
    path = []
    for each in sent:
        ahead, turn = each.velocity
        heading += turn * AGENT_PERIOD
        x, y = x + ahead * cos(heading) * AGENT_PERIOD, y + ahead * sin(heading) * AGENT_PERIOD
        path.append((x, y))
    assert LineString(path).intersects(Polygon(scene.area))
