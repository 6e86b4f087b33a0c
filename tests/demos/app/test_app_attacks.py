"""When the demo's malicious nodes attack, and when they must not."""

import json
from math import inf

import pytest

from rtron.demos.apps.logic.demo_logic.attacks import (
    Attacker,
    AttackOrder,
    OdometryMotion,
    ScanMotion,
    in_burst,
    read_order,
)

MACHINE = 0x0242AC110002
ORDER = {"mac": "02:42:ac:11:00:02", "attack": "msr", "after": 4.0, "goal": [1.0, 2.0], "run": 3}


@pytest.fixture
def trigger(tmp_path):
    path = tmp_path / "trigger.json"

    def put(**changes):
        path.write_text(json.dumps(ORDER | changes))

    put()
    return put, str(path)


@pytest.fixture
def attacker(trigger):
    return Attacker(OdometryMotion(), trigger[1], MACHINE)


def test_the_order_of_a_file(trigger):
    put, path = trigger
    assert read_order(path, MACHINE) == AttackOrder("msr", 4.0, (1.0, 2.0), 3)
    put(goal=None)
    assert read_order(path, MACHINE).goal is None


def test_an_order_for_another_machine_is_none(trigger):
    assert read_order(trigger[1], MACHINE + 1) is None


def test_without_a_file_there_is_no_order(monkeypatch, tmp_path):
    assert read_order(str(tmp_path / "missing"), MACHINE) is None
    monkeypatch.delenv("DEMO_TRIGGER", raising=False)
    attacker = Attacker(OdometryMotion())
    attacker.observe(0.0, (0.0, 0.0))
    assert attacker.due_attack(9.0, "msr") is None


def test_it_attacks_when_the_robot_has_been_under_way_for_long_enough(attacker):
    attacker.observe(10.0, (0.0, 0.0))
    attacker.observe(20.0, (0.1, 0.0))
    assert attacker.due_attack(23.9, "msr") is None
    assert attacker.due_attack(24.0, "msr").goal == (1.0, 2.0)


def test_it_does_not_attack_while_the_robot_stands(attacker):
    for second in range(100):
        attacker.observe(second, (0.04 * (second % 2), 0.0))
    assert attacker.due_attack(100.0, "msr") is None


def test_another_attack_is_not_its_business(attacker):
    attacker.observe(0.0, (0.0, 0.0))
    attacker.observe(1.0, (0.1, 0.0))
    assert attacker.due_attack(9.0, "rsr") is None


def test_a_new_order_waits_for_a_new_start(attacker, trigger):
    attacker.observe(0.0, (0.0, 0.0))
    attacker.observe(1.0, (0.1, 0.0))
    trigger[0](run=4)
    assert attacker.due_attack(9.0, "msr") is None
    attacker.observe(10.0, (0.2, 0.0))
    attacker.observe(11.0, (0.3, 0.0))
    assert attacker.due_attack(14.9, "msr") is None
    assert attacker.due_attack(15.0, "msr").run == 4


def test_a_robot_that_is_carried_back_has_not_set_off(attacker):
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
