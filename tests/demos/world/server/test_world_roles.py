"""What each role is told, on real sockets: a run from its reset to its end."""

from math import atan2, pi

import pytest
from world_client import KEY, LIMIT, SPEED, truth_when

from rtron.demos.world.client import WorldClient


@pytest.fixture
def owner(path):
    with WorldClient.connect(path, KEY, LIMIT) as owner:
        yield owner


def heading_error(pose, place):
    """Return by how much a robot does not head for a place, rad."""
    return (atan2(place[1] - pose[1], place[0] - pose[0]) - pose[2] + pi) % (2 * pi) - pi


def drive_until(condition, owner, base, velocity):
    """Return the first truth for which a condition holds.

    Until then the base is told the velocity (m/s, rad/s) that `velocity` gives for the newest.
    """
    for _ in range(400):
        truths = owner.poll(LIMIT)
        for truth in filter(condition, truths):
            return truth
        for truth in truths[-1:]:
            base.send({"velocity": velocity(truth)})
    raise AssertionError("it never came true")


def towards(place):
    """Return what drives a robot to a place; it steers all the way, since truths may come late."""

    def velocity(truth):
        error = heading_error(truth.pose, place)
        return [0.3 if abs(error) < 0.3 else 0.0, max(-0.3, min(0.3, error))]

    return velocity


def test_everybody_is_welcomed(client):
    for role in ("base", "lidar", "camera", "battery", "mission", "computer", "network"):
        welcome = client(role).welcome
        assert (welcome["welcome"], welcome["speed"]) == (role, SPEED)
        assert welcome["t"] >= 0


def test_devices_get_their_frames_at_their_rates(client, owner):
    owner.reset("rsr", 1, camera_rate=4)
    for role, period, size in (("base", 0.05, 0), ("lidar", 0.2, 1440), ("camera", 0.25, 230400)):
        device = client(role)
        frames = [device.next() for _ in range(5)]
        times = [frame.head["t"] for frame in frames]
        assert times[-1] - times[0] == pytest.approx(4 * period, abs=0.051)
        assert {len(frame.blob) for frame in frames} == {size}
        assert frames[-1].head["run"] > 0
    level = client("battery").next().head
    assert 0 < level["percentage"] <= 1 < level["voltage"]


def test_a_run_from_reset_to_a_collision(client, owner):
    base, mission = client("base"), client("mission")
    begun = owner.reset("gr", 5)
    owner.start()
    goal = mission.next().head
    assert (goal["run"], goal["goal"]) == (begun.run, begun.scene["goal"])
    hit = drive_until(lambda truth: truth.collided, owner, base, lambda _: [0.5, 0.6])
    assert hit.run == begun.run
    assert hit.commanded == (0.5, 0.6)
    assert base.until(lambda f: f.head["t"] >= hit.t).head["pose"] == pytest.approx(hit.pose)
    again = owner.reset("gr", 5)
    assert (again.run, again.scene) == (begun.run + 1, begun.scene)
    assert again.t >= hit.t
    fresh = truth_when(owner, lambda truth: truth.run == again.run)
    assert not fresh.collided
    assert list(fresh.pose[:2]) == again.scene["start"][:2]


def test_where_a_person_drives_the_mission_gets_no_goal(client, owner):
    mission = client("mission")
    owner.reset("agent", 5)
    owner.start()
    begun = owner.reset("gr", 5)
    owner.start()
    assert mission.next().head["run"] == begun.run


def test_the_robot_stops_when_its_driver_is_gone(client, owner):
    owner.reset("gr", 1)
    owner.start()
    base = client("base")
    base.send({"velocity": [0.1, 0.0]})
    truth_when(owner, lambda truth: truth.velocity[0] > 0)
    base.socket.close()
    assert not truth_when(owner, lambda truth: truth.velocity[0] == 0.0).collided


def test_the_network_device_hears_of_the_area(client, owner):
    network, base = client("network"), client("base")
    assert network.next().head == {"connected": True}
    scene = owner.reset("msr", 3).scene
    owner.start()
    drive_until(lambda truth: truth.in_area, owner, base, towards(scene["bad_goal"]))
    assert network.next().head == {"connected": False}
    owner.reset("msr", 3)
    assert network.next().head == {"connected": True}


def test_the_computer_hears_of_its_rate(client, owner):
    owner.set_image_rate(10.0)
    computer = client("computer")
    assert computer.next().head == {"rate": 10.0}
    owner.set_image_rate(2.5)
    assert computer.next().head == {"rate": 2.5}
    owner.set_image_rate(10.0)


def test_the_owner_counts_devices(client, owner):
    two = [client("lidar"), client("lidar")]
    assert owner.count_devices()["lidar"] == 2
    two[0].socket.close()
    for _ in range(100):
        if owner.count_devices()["lidar"] == 1:
            break
        owner.poll(LIMIT)
    counted = owner.count_devices()
    assert (counted["lidar"], counted["owner"], counted["camera"]) == (1, 1, 0)


def test_truths_of_earlier_runs_are_dropped_at_a_reset(owner):
    owner.reset("gr", 1)
    truth_when(owner, lambda truth: True)
    begun = owner.reset("gr", 2)
    assert {truth.run for truth in owner.poll(LIMIT)} == {begun.run}
