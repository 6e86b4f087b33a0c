"""Each way past the guard, against rospy and roscpp: found, stopped, released.

How soon it is found is measured by `python -m bench audit`, on a machine with nothing else to do.
"""

import os
import signal
from dataclasses import replace

import pytest
from audit_scene import OUT, STOP, ReturningGhost, ReturningIntruder, Scene, ghost, wait_until_found
from driven_base import CMD_VEL_GUARD, TURN_RIGHT, drive_plan
from harness import Ros1, wait_for

from rtron.vocabulary import Audit, OnForeign
from rtron.vocabulary.names import GUARD_NODE, SUPERVISOR_NODE

pytestmark = pytest.mark.ros1
RUNS = 2


@pytest.fixture(params=["rospy", pytest.param("roscpp", marks=pytest.mark.long)])
def program(request):
    if request.param == "rospy":
        return "driver.py"
    return request.getfixturevalue("roscpp_driver")


def wait_for_stop(scene, stops):
    wait_for(lambda: scene.stops() > stops, what="a stop while the intruder is there")


def wait_until_settled(scene):
    def settled():
        return len(scene.of_the_audit("no more:")) == len(scene.of_the_audit("alarm:"))

    wait_for(settled, what="the end of the alarms")


def wait_until_released(scene):
    """Clear the intrusion once it is over; who stops later does so anew."""
    wait_until_settled(scene)
    wait_for(scene.is_cleared, what="the guard's leave to drive again")
    wait_for(scene.released, what="the end of the stop")


def assert_found_and_stopped(scene, kind, intrude, runs=RUNS):
    """Intrude some times; each time the alarm must come, the robot stop and be released."""
    for _ in range(runs):
        stops = scene.stops()
        with intrude() as intruder:
            wait_until_found(scene, intruder, kind)
            wait_for_stop(scene, stops)
        wait_until_released(scene)


class Registered(ReturningIntruder):
    """Registers at the master for as long as it is there."""

    def __init__(self, ros1):
        super().__init__(lambda each: each.register(ros1.uri))
        self._ros1 = ros1

    def leave(self):
        self.unregister(self._ros1.uri)
        super().leave()


class Impostor(ReturningIntruder):
    """Takes a name, again when its owner has it back before anybody has asked who took it."""

    def __init__(self, ros1, name):
        super().__init__(lambda each: each.register(ros1.uri), name)
        self._ros1 = ros1

    def insist(self):
        if self._ros1.uri_of(self.name) != self.uri:
            self._way(self)


def bridged(scene, other):
    """Return an intruder of another master, which believes that the driver belongs to it."""
    driver = scene.driver_uri()
    return ReturningIntruder(lambda each: each.announce_through(other.uri, "/driver", driver))


def test_a_rogue_that_registers(ros1, program):
    with Scene(ros1, program) as scene:
        assert_found_and_stopped(scene, "foreign publisher", lambda: Registered(ros1))


def test_a_ghost_that_does_not_register(ros1, program):
    with Scene(ros1, program) as scene:
        addresses = (scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD))
        assert_found_and_stopped(scene, "ghost publisher", lambda: ghost(*addresses))


@pytest.mark.long
def test_a_rogue_behind_a_second_master(ros1, program, tmp_path):
    with Ros1(tmp_path / "other") as other, Scene(ros1, program) as scene:
        assert_found_and_stopped(scene, "ghost publisher", lambda: bridged(scene, other))


@pytest.mark.parametrize("name", [CMD_VEL_GUARD, GUARD_NODE])
def test_an_impostor_with_the_guards_name(ros1, program, name):
    with Scene(ros1, program) as scene:
        for _ in range(RUNS):
            stops = scene.stops()
            with Impostor(ros1, name) as impostor:
                wait_until_found(scene, impostor, "impostor")
                wait_for_stop(scene, stops)
                wait_for(impostor.shut_down.is_set, what="the master's call to the impostor")
            wait_for(scene.driver_hears_guard, what="the guard's return")
            wait_until_released(scene)
        assert not scene.guard.ended


@pytest.mark.long
def test_a_driver_that_joins_late_finds_a_ghost_waiting(ros1, program):
    with Scene(ros1, program, drives=False) as scene, Registered(ros1) as rogue:
        wait_for(lambda: scene.alarms("alarm: foreign publisher"), what="the alarm")
        scene.start_driver()
        wait_until_found(scene, rogue, "foreign publisher")


@pytest.mark.long
def test_a_driver_that_was_away_when_the_robot_was_stopped_is_told_to_rest(ros1, program):
    with Scene(ros1, program) as scene:
        with Registered(ros1) as rogue:
            wait_until_found(scene, rogue, "foreign publisher")
            scene.driver.kill()
        wait_until_released(scene)
        stops = scene.stops()
        scene.drive()
        wait_for(lambda: scene.stops() > stops, what="the stop")


@pytest.mark.long
def test_where_the_plan_says_alarm_nothing_is_stopped(ros1, program):
    plan = replace(drive_plan(), audit=Audit(on_foreign=OnForeign.ALARM))
    with Scene(ros1, program, plan) as scene:
        scene.navigate()
        wait_for(lambda: len(scene.driven.navigation()) > 1, what="navigation at the driver")
        with ghost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
            before = len(scene.driven.navigation())
            wait_for(lambda: len(scene.driven.navigation()) > before + 20, what="navigation")
            wait_for(
                lambda: intruder.insist() or scene.driven.turns() > 100, what="the ghost's messages"
            )
            assert not intruder.shut_down.is_set()
        wait_until_settled(scene)
        assert not any("stopping: /driver hears" in text for _, text in scene.log.lines)


@pytest.mark.long
def test_an_impostor_with_the_supervisors_name(ros1, program):
    with Scene(ros1, program) as scene:
        wait_for(lambda: SUPERVISOR_NODE in ros1.publishers(OUT), what="the supervisor")
        wait_for(lambda: scene.hears(SUPERVISOR_NODE), what="its connection")
        wait_for(scene.is_audited, what="the audit, which then knows the supervisor's address")
        stops = scene.stops()
        with Impostor(ros1, SUPERVISOR_NODE) as impostor:
            wait_until_found(scene, impostor, "impostor")
            wait_for_stop(scene, stops)
        wait_until_released(scene)


def test_the_robot_stays_stopped_until_a_person_clears_it(ros1, program):
    with Scene(ros1, program) as scene:
        nav = scene.navigate()
        wait_for(lambda: len(scene.driven.navigation()) > 1, what="navigation at the driver")
        with ghost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
            refused = scene.clear()
            assert refused.code == 2
            assert "stays stopped" in refused.log
        wait_until_settled(scene)
        passed, stops = len(scene.driven.navigation()), scene.stops()
        wait_for(lambda: scene.stops() > stops + 20, what="the stop that goes on")
        assert len(scene.driven.navigation()) == passed
        wait_for(scene.is_cleared, what="the guard's leave to drive again")
        wait_for(lambda: len(scene.driven.navigation()) > passed, what="navigation again")
        assert not nav.ended


def kill_guard(scene):
    """Kill the guard; return how many intrusions its supervisor had told of."""
    told = len(scene.alarms("alarm: intrusion"))
    os.kill(scene.guard_process(), signal.SIGKILL)
    return told


def kill_guard_and_supervisor(scene):
    """Kill those that would start each other again, and begin anew: with nothing told yet."""
    both = (scene.guard_process(), scene.guard.pid)
    for number in (signal.SIGSTOP, signal.SIGKILL):
        for each in both:
            os.kill(each, number)
    wait_for(lambda: scene.guard.ended, what="the end of the supervisor")
    scene.start_guard()
    return 0


@pytest.mark.long
@pytest.mark.parametrize("kill", [kill_guard, kill_guard_and_supervisor])
def test_an_intrusion_outlives_the_guard(ros1, program, kill):
    with Scene(ros1, program) as scene:
        scene.navigate()
        wait_for(lambda: len(scene.driven.navigation()) > 1, what="navigation at the driver")
        with ghost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
        wait_until_settled(scene)
        passed = len(scene.driven.navigation())
        told = kill(scene)
        wait_for(lambda: scene.alarms("alarm: intrusion")[told:], what="the next guard's alarm")
        wait_for(scene.driver_hears_guard, what="the driver's connection to the next guard")
        stops = scene.stops()
        wait_for(lambda: scene.stops() > stops + 20, what="the next guard's stop")
        assert len(scene.driven.navigation()) == passed
        wait_for(scene.is_cleared, what="the next guard's leave to drive again")
        wait_for(lambda: len(scene.driven.navigation()) > passed, what="navigation again")


def test_each_message_of_an_intruder_is_answered(ros1, program):
    with Scene(ros1, program) as scene:
        with ReturningGhost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD)) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
            heard, turns = len(scene.driven.messages()), scene.driven.turns()
            wait_for(lambda: scene.driven.turns() > turns + 200, what="the ghost's messages")
        assert answered_share(scene.driven.messages()[heard:]) > 0.8
        wait_until_released(scene)


@pytest.mark.long
def test_a_ghost_that_keeps_sending_the_guard_away_is_answered_and_the_driver_kept(ros1, program):
    with Scene(ros1, program) as scene:
        stops = scene.stops()
        with ReturningGhost(scene.driver_uri()) as intruder:
            wait_until_found(scene, intruder, "ghost publisher")
            wait_for(lambda: scene.stops() > stops + 50, what="stops between its words")
        wait_for(scene.driver_hears_guard, what="the guard at the driver again")
        wait_until_released(scene)


def answered_share(messages):
    """Return how many stops there are for each message of an intruder; unanswered, 0.1.

    Only counts are compared: rospy reads each connection in a thread, and keeps no order.
    """
    turns = sum(turn == TURN_RIGHT for _, turn in messages)
    assert turns > 50
    return messages.count(STOP) / turns
