"""What the demo's robot sees, and what the smaller nodes make of it."""

from array import array
from itertools import pairwise
from math import atan2, inf, pi
from types import SimpleNamespace

import pytest

from rtron.demos.apps.logic.demo_logic import message_fields
from rtron.demos.apps.logic.demo_logic.navigation import GoalMonitor
from rtron.demos.apps.logic.demo_logic.perception import (
    BEEP,
    COLOURS,
    CRUISE,
    NEAR_PEOPLE,
    PEDESTRIAN,
    Beeper,
    Detection,
    FrameLimiter,
    MaxVelocity,
    from_json,
    recognise,
    to_json,
)
from rtron.demos.apps.logic.demo_logic.teleoperation import TeleopSafety, read_command

WIDTH, HEIGHT = 320, 240
FOCAL = 265.0


def picture(colour=b"\xff\x00\xff", left=0, top=0, width=0, height=0):
    image = bytearray(b"\x78" * (WIDTH * HEIGHT * 3))
    for row in range(top, top + height):
        start = (row * WIDTH + left) * 3
        image[start : start + 3 * width] = colour * width
    return bytes(image)


@pytest.mark.parametrize("kind", COLOURS)
def test_each_colour_is_its_kind(kind):
    (seen,) = recognise(picture(COLOURS[kind], 80, 60, 160, 120), WIDTH, HEIGHT)
    assert seen.kind == kind
    assert seen.area == pytest.approx(0.25, rel=0.05)
    assert seen.bearing == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("left", "middle"), [(0, 19.5), (280, 299.5)])
def test_the_bearing_is_that_of_the_things_middle(left, middle):
    (seen,) = recognise(picture(left=left, width=40, height=240), WIDTH, HEIGHT)
    assert seen.bearing == pytest.approx(atan2(159.5 - middle, FOCAL), abs=0.01)


def test_grey_shows_nothing():
    assert recognise(picture(), WIDTH, HEIGHT) == []


def test_a_speck_is_nothing():
    assert recognise(picture(width=4, height=4), WIDTH, HEIGHT) == []
    assert recognise(picture(width=8, height=4), WIDTH, HEIGHT) != []


def test_several_kinds_in_one_image():
    image = bytearray(picture(width=40, height=40))
    image[-WIDTH * 3 * 40 :] = b"\x00\xff\x00" * WIDTH * 40
    assert [seen.kind for seen in recognise(bytes(image), WIDTH, HEIGHT)] == [
        PEDESTRIAN,
        "green_light",
    ]


def test_an_image_that_is_too_short_does_no_harm():
    assert recognise(b"\xff\x00\xff", WIDTH, HEIGHT) == []
    assert recognise(b"", 0, 0) == []


def test_detections_survive_their_text():
    seen = [Detection(PEDESTRIAN, 0.2, -0.1), Detection("red_light", 0.01, 0.3)]
    assert from_json(to_json(seen)) == seen


@pytest.mark.parametrize(("area", "limit"), [(0.079, CRUISE), (0.08, NEAR_PEOPLE)])
def test_near_people_it_drives_slowly(area, limit):
    decided = MaxVelocity()
    assert decided.value == CRUISE
    decided.update([Detection(PEDESTRIAN, area, 0.0)])
    assert decided.value == limit
    decided.update([Detection("red_light", 0.5, 0.0)])
    assert decided.value == CRUISE


@pytest.mark.parametrize(("rate", "taken"), [(10, 100), (5, 50), (2, 20), (20, 100), (0, 1)])
def test_images_are_skipped_evenly(rate, taken):
    limiter = FrameLimiter(rate)
    found = [number for number in range(100) if limiter.accepts(7.0 + number / 10)]
    assert len(found) == pytest.approx(taken, abs=1)
    gaps = {b - a for a, b in pairwise(found)}
    assert max(gaps, default=0) - min(gaps, default=0) <= 1


def test_after_a_pause_no_crowd_of_images_is_taken():
    limiter = FrameLimiter(1)
    assert [limiter.accepts(100.0), *(limiter.accepts(200.0) for _ in range(4))].count(True) == 3


def test_a_beep_for_who_comes_into_sight():
    beeper, person = Beeper(), [Detection(PEDESTRIAN, 0.1, 0.0)]
    assert [beeper.beeps(person), beeper.beeps(person)] == [True, False]
    assert not any(beeper.beeps([]) for _ in range(9))
    assert not beeper.beeps(person)
    assert not any(beeper.beeps([]) for _ in range(10))
    assert beeper.beeps(person)
    assert len(BEEP) == 800
    assert min(BEEP) < 128 < max(BEEP)


@pytest.mark.parametrize(("ahead", "left"), [(0.25, (0.0, 0.5)), (0.26, (0.2, 0.5))])
def test_what_is_near_stops_teleoperation_forwards(ahead, left):
    safety = TeleopSafety()
    safety.set_scan([ahead], 0.0, pi)
    assert safety.limit((0.2, 0.5)) == left
    assert safety.limit((-0.2, 0.5)) == (-0.2, 0.5)


def test_only_what_is_ahead_counts():
    safety, step = TeleopSafety(), pi / 180
    assert safety.limit((0.2, 0.0)) == (0.0, 0.0)
    safety.set_scan([1.0] * 31 + [0.2] * 299 + [1.0] * 30, 0.0, step)
    assert safety.limit((0.2, 0.0)) == (0.2, 0.0)
    safety.set_scan([1.0] * 331 + [0.2] + [1.0] * 28, 0.0, step)
    assert safety.limit((0.2, 0.0)) == (0.0, 0.0)
    safety.set_scan([0.0] * 180 + [inf] * 180, 0.0, step)
    assert safety.limit((0.2, 0.0)) == (0.2, 0.0)


@pytest.mark.parametrize(
    ("text", "velocity"),
    [("0.1 -0.5\n", (0.1, -0.5)), ("", None), ("0.1", None), ("nan 0", None), ("a b", None)],
)
def test_teleoperation_is_what_a_file_says(tmp_path, text, velocity):
    path = tmp_path / "command"
    path.write_text(text)
    assert read_command(str(path)) == velocity


def test_without_a_file_nobody_teleoperates(tmp_path):
    assert read_command("") is None
    assert read_command(str(tmp_path / "command")) is None


def test_the_errand_is_done_once():
    goal_monitor = GoalMonitor()
    assert not goal_monitor.has_arrived((1.0, 1.0, 0.0))
    goal_monitor.begin([1.0, 1.0])
    assert not goal_monitor.has_arrived((0.8, 1.0, 0.0))
    assert goal_monitor.has_arrived((0.9, 1.0, 0.0))
    assert not goal_monitor.has_arrived((1.0, 1.0, 0.0))


class Message:
    """A message with any fields."""

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        self.__dict__[name] = Message()
        return self.__dict__[name]


def test_odometry_says_what_the_base_says():
    odometry, transform = Message(), Message()
    message_fields.fill_odometry(odometry, {"pose": [1, 2, 0.5], "velocity": [0.2, -0.1]})
    message_fields.fill_transform(transform, odometry)
    assert message_fields.pose_in(odometry) == pytest.approx((1.0, 2.0, 0.5))
    assert message_fields.velocity_in(odometry.twist.twist) == (0.2, -0.1)
    assert (odometry.header.frame_id, transform.child_frame_id) == ("odom", "base_footprint")
    assert (transform.transform.translation.x, transform.transform.translation.y) == (1.0, 2.0)
    assert type(odometry.pose.pose.position.x) is float


def test_a_scan_says_what_the_lidar_says():
    scan, head = Message(), {"angle_min": 0, "angle_increment": 0.5}
    head |= {"range_min": 0.12, "range_max": 3.5}
    message_fields.fill_scan(scan, head, array("f", [1.0, inf, 0.5]).tobytes())
    assert list(scan.ranges) == [1.0, inf, 0.5]
    assert (scan.angle_min, scan.angle_max) == (0.0, 1.0)
    assert type(scan.angle_min) is float


def test_the_other_messages():
    image, battery, goal, twist = Message(), SimpleNamespace(), Message(), Message()
    battery.POWER_SUPPLY_STATUS_DISCHARGING = 2
    message_fields.fill_image(image, {"width": 320, "height": 240})
    message_fields.fill_battery(battery, {"percentage": 1, "voltage": 11})
    message_fields.fill_goal(goal, (1, 2))
    message_fields.fill_twist(twist, (0.1, 0.2))
    assert (image.step, image.encoding) == (960, "rgb8")
    assert (battery.percentage, battery.voltage, battery.present) == (1.0, 11.0, True)
    assert (goal.header.frame_id, goal.pose.orientation.w) == ("map", 1.0)
    assert (goal.pose.position.x, goal.pose.position.y) == (1.0, 2.0)
    assert message_fields.velocity_in(twist) == (0.1, 0.2)
