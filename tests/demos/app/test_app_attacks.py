"""When the demo's malicious nodes attack, and when they must not."""

import json
from math import inf

import pytest

from rtron.demos.apps.logic.demo_logic.attack_timing import Attacker, in_burst
from rtron.demos.apps.logic.demo_logic.attack_trigger import AttackOrder, TriggerFile
from rtron.demos.apps.logic.demo_logic.motion_detection import OdometryMotion, ScanMotion

MACHINE = 0x0242AC110002
ORDER = {"mac": "02:42:ac:11:00:02", "attack": "msr", "after": 4.0, "goal": [1.0, 2.0], "run": 3}


@pytest.fixture
def trigger(tmp_path):
    path = tmp_path / "trigger.json"

    def put(written=None, **changes):
        new = path.with_suffix(".new")
        new.write_text(json.dumps(ORDER | changes) if written is None else written)
        new.replace(path)

    put()
    return TriggerFile(str(path), MACHINE), put, path


def attacker_of(trigger):
    return Attacker(OdometryMotion(), trigger[0])


def test_the_order_of_a_file(trigger):
    assert trigger[0].order() == AttackOrder("msr", 4.0, (1.0, 2.0), 3)


def test_the_file_is_read_again_when_it_changes(trigger):
    file, put, path = trigger
    file.order()
    put(after=5.0)
    assert file.order().after == 5.0
    path.unlink()
    assert file.order() is None
    put()
    assert file.order().after == 4.0


@pytest.mark.parametrize(
    "changes",
    [
        {"mac": "02:42:ac:11:00:03"},
        {"mac": "somebody"},
        {"mac": 7},
        {"attack": "none"},
        {"attack": ["gr"]},
        {"after": "soon"},
        {"after": float("nan")},
        {"goal": [1.0]},
        {"goal": "home"},
        {"goal": [1.0, float("inf")]},
        {"run": None},
    ],
)
def test_an_order_for_others_or_a_broken_one_is_none(trigger, changes):
    file, put, _ = trigger
    put(**changes)
    assert file.order() is None


@pytest.mark.parametrize("text", ["", "[]", "{}", "7", "null", "{"])
def test_a_file_that_says_nothing_is_no_order(trigger, text):
    file, put, _ = trigger
    put(text)
    assert file.order() is None


def test_without_a_file_there_is_no_order(monkeypatch, tmp_path):
    monkeypatch.delenv("DEMO_TRIGGER", raising=False)
    assert TriggerFile().order() is None
    assert TriggerFile(str(tmp_path / "missing")).order() is None


def test_it_attacks_when_the_robot_has_been_under_way_for_long_enough(trigger):
    attacker = attacker_of(trigger)
    attacker.observe(10.0, (0.0, 0.0))
    attacker.observe(20.0, (0.1, 0.0))
    assert attacker.due_attack(23.9, "msr") is None
    assert attacker.due_attack(24.0, "msr").goal == (1.0, 2.0)


def test_it_does_not_attack_while_the_robot_stands(trigger):
    attacker = attacker_of(trigger)
    for second in range(100):
        attacker.observe(second, (0.04 * (second % 2), 0.0))
    assert attacker.due_attack(100.0, "msr") is None


def test_another_attack_is_not_its_business(trigger):
    attacker = attacker_of(trigger)
    attacker.observe(0.0, (0.0, 0.0))
    attacker.observe(1.0, (0.1, 0.0))
    assert attacker.due_attack(9.0, "rsr") is None


def test_a_new_order_waits_for_a_new_start(trigger):
    attacker = attacker_of(trigger)
    attacker.observe(0.0, (0.0, 0.0))
    attacker.observe(1.0, (0.1, 0.0))
    trigger[1](run=4)
    assert attacker.due_attack(9.0, "msr") is None
    attacker.observe(10.0, (0.2, 0.0))
    attacker.observe(11.0, (0.3, 0.0))
    assert attacker.due_attack(14.9, "msr") is None
    assert attacker.due_attack(15.0, "msr").run == 4


def test_a_robot_that_is_carried_back_has_not_set_off(trigger):
    attacker = attacker_of(trigger)
    attacker.observe(0.0, (0.0, 0.0))
    attacker.observe(1.0, (0.4, 0.0))
    attacker.observe(2.0, (0.8, 0.0))
    attacker.observe(8.0, (0.0, 0.0))
    assert attacker.due_attack(9.0, "msr") is None


@pytest.mark.parametrize(("changed", "moved"), [(54, False), (55, True)])
def test_a_scan_tells_that_the_robot_moves(changed, moved):
    eyes = ScanMotion()
    assert not eyes.has_moved([1.0] * 360)
    assert eyes.has_moved([1.05] * changed + [1.0] * (360 - changed)) == moved


def test_a_scan_that_showed_movement_goes_on_doing_so_until_it_is_forgotten():
    eyes = ScanMotion()
    eyes.has_moved([1.0] * 4)
    assert eyes.has_moved([2.0] * 4)
    assert eyes.has_moved([1.0] * 4)
    eyes.reset()
    assert not eyes.has_moved([1.0] * 4)


def test_rays_without_echo_are_no_movement():
    eyes = ScanMotion()
    assert not eyes.has_moved([inf] * 4)
    assert not eyes.has_moved([inf] * 4)


def test_a_scan_of_another_length_begins_anew():
    eyes = ScanMotion()
    eyes.has_moved([1.0] * 4)
    assert not eyes.has_moved([2.0] * 5)


@pytest.mark.parametrize(
    ("now", "sends"), [(0.0, True), (0.29, True), (0.31, False), (0.59, False), (0.61, True)]
)
def test_bursts_and_pauses(now, sends):
    assert in_burst(600.0 + now) == sends
