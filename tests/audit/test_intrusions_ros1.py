"""Each way past the guard, against rospy and roscpp: found, stopped, released.

How soon it is found is measured by `python -m bench audit`, on a machine with nothing else to do.
"""

from dataclasses import replace

import pytest
from drive import CMD_VEL_GUARD, drive_plan
from harness import Ros1, wait_for
from scene import OUT, Scene

from bench.intruder import Intruder
from rtron.vocabulary import Audit, OnForeign
from rtron.vocabulary.names import SUPERVISOR_NODE

pytestmark = pytest.mark.ros1
RUNS = 3
ROGUE = "/intruder"


@pytest.fixture(params=["rospy", "roscpp"])
def program(request):
    if request.param == "rospy":
        return "driver.py"
    return request.getfixturevalue("roscpp_driver")


def wait_until_found(scene, intruder, kind):
    """Wait for the alarm that this connection, not an earlier one, raises."""
    wait_for(lambda: intruder.first, what="the intruder's connection")
    scene.log.wait(f"alarm: {kind}", intruder.first - 1_000_000_000, 10)


def wait_for_stop(scene, stops):
    wait_for(lambda: scene.stops() > stops, what="a stop while the intruder is there")


def assert_settled(scene, after):
    def settled():
        raised, settled = scene.of_the_audit("alarm:"), scene.of_the_audit("no more:")
        return len(settled) >= len(raised) > after

    wait_for(settled, what="the end of the alarms")


def assert_found_and_stopped(scene, kind, intrude, runs=RUNS):
    """Intrude some times; each time the alarm must come, the robot stop and be released."""
    for _ in range(runs):
        alarms, stops = len(scene.of_the_audit()), scene.stops()
        with intrude() as intruder:
            wait_until_found(scene, intruder, kind)
            wait_for_stop(scene, stops)
        assert_settled(scene, alarms)


class Registered(Intruder):
    """Registers at the master for as long as it is there."""

    def __init__(self, ros1, name=ROGUE):
        super().__init__(name, OUT)
        self._ros1 = ros1

    def __enter__(self):
        self.register(self._ros1.uri)
        return self

    def leave(self):
        self.unregister(self._ros1.uri)
        super().leave()


class Ghost(Intruder):
    """Tells the driver of itself, and nobody else."""

    def __init__(self, scene):
        super().__init__(ROGUE, OUT)
        self._scene = scene

    def __enter__(self):
        self.invite(self._scene.driver_uri(), self._scene.ros1.uri_of(CMD_VEL_GUARD))
        return self


class Bridged(Intruder):
    """Is known to another master, which believes that the driver belongs to it."""

    def __init__(self, scene, other):
        super().__init__(ROGUE, OUT)
        self._scene, self._other = scene, other

    def __enter__(self):
        self.invite_through(self._other.uri, "/driver", self._scene.driver_uri())
        return self


def test_a_rogue_that_registers(ros1, program):
    with Scene(ros1, program) as scene:
        assert_found_and_stopped(scene, "foreign publisher", lambda: Registered(ros1))


def test_a_ghost_that_does_not_register(ros1, program):
    with Scene(ros1, program) as scene:
        assert_found_and_stopped(scene, "ghost publisher", lambda: Ghost(scene))


def test_a_rogue_behind_a_second_master(ros1, program, tmp_path):
    with Ros1(tmp_path / "other") as other, Scene(ros1, program) as scene:
        assert_found_and_stopped(scene, "ghost publisher", lambda: Bridged(scene, other))


def test_an_impostor_with_the_guards_name(ros1, program):
    with Scene(ros1, program) as scene:
        for _ in range(RUNS):
            alarms, stops = len(scene.of_the_audit()), scene.stops()
            with Intruder(CMD_VEL_GUARD, OUT) as impostor:
                impostor.register(ros1.uri)
                wait_until_found(scene, impostor, "impostor")
                wait_for_stop(scene, stops)
                wait_for(impostor.shut_down.is_set, what="the master's call to the impostor")
            assert_settled(scene, alarms)
            wait_for(scene.driver_hears_guard, what="the guard's return")
        assert not scene.guard.ended


def test_a_driver_that_joins_late_finds_a_ghost_waiting(ros1, program):
    with Scene(ros1, program, drives=False) as scene, Registered(ros1) as rogue:
        scene.log.wait("alarm: foreign publisher", 0, 5)
        scene.start_driver()
        wait_for(lambda: rogue.first, what="the rogue's connection")
        scene.log.wait("/driver hears", 0, 10)


def test_where_the_plan_says_alarm_nothing_is_stopped(ros1, program):
    plan = replace(drive_plan(), audit=Audit(on_foreign=OnForeign.ALARM))
    with Scene(ros1, program, plan) as scene:
        scene.navigate()
        wait_for(lambda: len(scene.driven.navigation()) > 1, what="navigation at the driver")
        stops = scene.stops()
        with Ghost(scene) as ghost:
            wait_until_found(scene, ghost, "ghost publisher")
            before = len(scene.driven.navigation())
            wait_for(lambda: len(scene.driven.navigation()) > before + 20, what="navigation")
            wait_for(lambda: scene.driven.turns() > 100, what="the ghost's messages")
            assert not ghost.shut_down.is_set()
        assert_settled(scene, 0)
        assert scene.stops() == stops


def test_an_impostor_with_the_supervisors_name(ros1, program):
    with Scene(ros1, program) as scene:
        wait_for(lambda: SUPERVISOR_NODE in ros1.publishers(OUT), what="the supervisor")
        wait_for(lambda: scene.hears(SUPERVISOR_NODE), what="its connection")
        alarms, stops = len(scene.of_the_audit()), scene.stops()
        with Intruder(SUPERVISOR_NODE, OUT) as impostor:
            impostor.register(ros1.uri)
            wait_until_found(scene, impostor, "impostor")
            wait_for_stop(scene, stops)
        assert_settled(scene, alarms)
