"""An intruder is there while a process of the guard dies: the robot stays stopped (ROS 1)."""

import os
import re
import signal
import time
from contextlib import contextmanager, suppress
from dataclasses import replace

import pytest
from audit_scene import ReturningGhost, Scene, wait_until_found
from driven_base import CMD_VEL_GUARD, drive_plan
from harness import wait_for

from rtron.vocabulary import GUARD_NODE, SECOND, Supervision

pytestmark = pytest.mark.ros1
LOST = "the bulk process is gone"
SILENCE_S = 1.1
"""After an intruder's last message the guard itself refuses for a second."""
COMPLETE = "the audit has looked at the whole graph"


IMPATIENCE_S = 5
NAVIGATION_HZ = 10
UNWATCHED = f"nobody has looked for intruders for {IMPATIENCE_S} s"


@contextmanager
def driving(ros1, plan):
    with Scene(ros1, "driver.py", plan) as scene:
        scene.navigate()
        wait_for(lambda: len(scene.driven.navigation()) > 1, what="navigation at the driver")
        wait_for(scene.is_audited, what="the audit")
        yield scene


@pytest.fixture
def scene(ros1):
    with driving(ros1, drive_plan()) as scene:
        yield scene


@pytest.fixture
def impatient(ros1):
    """Return a robot that does not drive for long without an audit."""
    supervision = Supervision(audit_within=IMPATIENCE_S * SECOND)
    with driving(ros1, replace(drive_plan(), supervision=supervision)) as scene:
        scene.log.lines.clear()  # on a busy machine the start itself took longer than the bound
        yield scene


def is_unwatched(scene, gap=""):
    return bool(scene.alarms(f"alarm: unseen: /cmd_vel: {UNWATCHED}: {gap}"))


def assert_stopped_until_watched(scene):
    wait_for(lambda: scene.stops() > 0, what="the stop")
    passed = len(scene.driven.navigation())
    wait_for(lambda: scene.alarms(f"no more: unseen: /cmd_vel: {UNWATCHED}"), what="an audit")
    wait_for(lambda: len(scene.driven.navigation()) > passed, what="navigation again")
    assert not scene.alarms("alarm: intrusion")


def intrude(scene, ros1):
    return ReturningGhost(scene.driver_uri(), ros1.uri_of(CMD_VEL_GUARD))


def wait_until_cleared(scene, passed):
    wait_for(scene.is_cleared, what="the guard's leave to drive again")
    wait_for(lambda: len(scene.driven.navigation()) > passed, what="navigation again")


def bulk_process(scene):
    return int(re.findall(r"the bulk process is there, process (\d+)", scene.guard.log)[-1])


def end_bulk_process(scene):
    """Kill it and wait until the command process knows."""
    bulk, losses = bulk_process(scene), scene.guard.log.count(LOST)
    os.kill(bulk, signal.SIGKILL)
    wait_for(lambda: scene.guard.log.count(LOST) > losses, what="the loss of the bulk process")


def test_an_intrusion_outlives_the_process_of_the_audit(ros1, scene):
    with intrude(scene, ros1) as intruder:
        wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: scene.alarms("alarm: intrusion"), what="the stop")
        passed, bulk, stops = len(scene.driven.navigation()), bulk_process(scene), scene.stops()
        turns = scene.driven.turns()
        end_bulk_process(scene)
        assert "stays stopped" in scene.ask_to_clear()["error"]
        wait_for(lambda: scene.driven.turns() > turns + 50, what="the intruder, which goes on")
        wait_for(lambda: scene.stops() > stops + 50, what="the answers to it")
        wait_for(lambda: scene.guard.log.count(COMPLETE) == 2, what="the next audit")
        assert bulk_process(scene) != bulk
        refused = scene.clear()
        assert refused.code == 2
        assert "stays stopped" in refused.log
        assert len(scene.driven.navigation()) == passed
    wait_until_cleared(scene, passed)
    assert len(scene.alarms("alarm: intrusion")) == 1
    assert scene.guard.log.count("the guard begins") == 1


@pytest.mark.long
@pytest.mark.parametrize(
    ("hanging", "alarm"),
    [("driver", "/driver cannot be audited"), ("master", "the master does not answer")],
)
def test_an_audit_that_nobody_answers_takes_no_alarm_back(ros1, scene, hanging, alarm):
    with intrude(scene, ros1) as intruder:
        wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: scene.alarms("alarm: intrusion"), what="the stop")
        passed, settled = len(scene.driven.navigation()), len(scene.of_the_audit("no more:"))
        process = scene.driver if hanging == "driver" else ros1.master
        process.tell(signal.SIGSTOP)
        end_bulk_process(scene)
        wait_for(lambda: scene.alarms(f"alarm: unseen: {alarm}"), what="an audit in vain")
    unseen = f"the audit has not looked at everything.*{hanging}.*answer"
    wait_for(lambda: re.search(unseen, scene.ask_to_clear()["error"]), what="the reason")
    assert scene.guard.log.count(COMPLETE) == 1
    assert len(scene.of_the_audit("no more:")) == settled
    process.tell(signal.SIGCONT)
    wait_until_cleared(scene, passed)


@pytest.mark.long
def test_nothing_is_cleared_while_no_audit_is_there(ros1, scene):
    with intrude(scene, ros1) as intruder:
        wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: scene.alarms("alarm: intrusion"), what="the stop")
    left = time.monotonic()
    wait_for(lambda: time.monotonic() > left + SILENCE_S, what="a second of silence")
    passed = len(scene.driven.navigation())
    end_bulk_process(scene)
    refused = scene.ask_to_clear()
    assert "the audit is not connected: nobody knows" in refused["error"]
    assert len(scene.driven.navigation()) == passed
    wait_until_cleared(scene, passed)
    assert len(scene.alarms("alarm: intrusion")) == 1


@pytest.mark.long
def test_a_guard_that_begins_beside_an_intruder_is_stopped_and_not_cleared(ros1, scene):
    with intrude(scene, ros1) as intruder:
        wait_until_found(scene, intruder, "ghost publisher")
        wait_for(lambda: scene.alarms("alarm: intrusion"), what="the stop")
        passed = len(scene.driven.navigation())
        os.kill(ros1.ask(ros1.uri_of(GUARD_NODE), "getPid"), signal.SIGKILL)
        wait_for(lambda: scene.alarms("alarm: intrusion")[1:], what="the next guard's alarm")
        wait_for(lambda: scene.guard.log.count(COMPLETE) == 2, what="the audit's findings")
        stops = scene.stops()
        wait_for(lambda: scene.stops() > stops + 20, what="the next guard's stop")
        for _ in range(3):
            refused = scene.clear()
            assert refused.code == 2
            assert "stays stopped" in refused.log
        assert len(scene.driven.navigation()) == passed
    wait_until_cleared(scene, passed)


@pytest.mark.long
def test_a_robot_without_an_audit_is_stopped_until_there_is_one(impatient):
    """The bulk process ends as soon as it begins, until the robot rests."""

    def is_stopped():
        with suppress(ProcessLookupError):
            os.kill(bulk_process(impatient), signal.SIGKILL)
        return is_unwatched(impatient)

    wait_for(is_stopped, what="the end of the guard's patience")
    assert_stopped_until_watched(impatient)


@pytest.mark.long
def test_an_audit_that_begins_without_the_master_is_none(ros1, impatient):
    ros1.master.tell(signal.SIGSTOP)
    end_bulk_process(impatient)
    wait_for(
        lambda: is_unwatched(impatient, "the master has not answered"),
        what="the end of the guard's patience",
    )
    ros1.master.tell(signal.SIGCONT)
    assert_stopped_until_watched(impatient)


@pytest.mark.long
def test_a_driver_that_does_not_tell_who_speaks_to_it_is_stopped(impatient):
    impatient.driver.tell(signal.SIGSTOP)
    gap = "/driver cannot be audited: no answer within 1 s"
    wait_for(lambda: is_unwatched(impatient, gap), what="the end of the guard's patience")
    impatient.driver.tell(signal.SIGCONT)
    assert_stopped_until_watched(impatient)


@pytest.mark.long
def test_the_stop_outlives_the_guard(ros1, impatient):
    """The next one begins with it: it has not heard of an audit by then."""
    impatient.driver.tell(signal.SIGSTOP)
    wait_for(lambda: is_unwatched(impatient, "/driver cannot be audited"), what="the stop")
    os.kill(ros1.ask(ros1.uri_of(GUARD_NODE), "getPid"), signal.SIGKILL)
    wait_for(lambda: is_unwatched(impatient, "the audit does not answer"), what="the next stop")
    impatient.driver.tell(signal.SIGCONT)
    assert_stopped_until_watched(impatient)


def test_a_robot_drives_on_without_the_master_and_an_alarm_tells_it(ros1, impatient):
    ros1.master.kill()
    gone = "unseen: the master does not answer"
    wait_for(lambda: impatient.alarms(f"alarm: {gone}"), what="the alarm")
    end = len(impatient.driven.navigation()) + NAVIGATION_HZ * (IMPATIENCE_S + 1)
    wait_for(
        lambda: len(impatient.driven.navigation()) > end,
        what="navigation, which goes on for longer than the bound",
    )
    assert impatient.stops() == 0
    ros1.start_master()
    wait_for(lambda: impatient.alarms(f"no more: {gone}"), what="the end of the alarm")
    assert not impatient.alarms(UNWATCHED)
