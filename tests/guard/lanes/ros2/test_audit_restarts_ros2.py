"""An intruder is there while a process of the guard dies: the robot stays stopped (ROS 2)."""

import os
import re
import signal
from contextlib import suppress

import pytest
from harness import lives, wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from guarded_base2 import OUT, GuardedBase2

pytestmark = pytest.mark.ros2
COMPLETE = "the audit has looked at the whole graph"


@pytest.fixture
def calm(ros2):
    """Return a base that is audited."""
    base = GuardedBase2(ros2, "stop")
    base.start()
    wait_for(lambda: COMPLETE in base.guard.log, what="the audit")
    return base


@pytest.fixture
def base(calm):
    """Return a base in whose domain a rogue speaks past the guard."""
    base = calm
    base.rogue = base.speaker("/rogue", OUT, "7.0")
    wait_for(lambda: base.alarms("alarm: intrusion"), what="the stop")
    wait_for(lambda: base.speeds("0.0") > 20, what="the stop at the driver")
    base.passed = base.speeds("0.5")
    return base


def process(base, words):
    return int(re.findall(rf"{words}, process (\d+)", base.guard.log)[-1])


def assert_stopped(base):
    """Nothing but stops and the rogue's words reaches the driver, and no person can change that."""
    stops, rogues = base.speeds("0.0"), base.speeds("7.0")
    wait_for(lambda: base.speeds("7.0") > rogues + 20, what="the rogue, which goes on")
    wait_for(lambda: base.speeds("0.0") > stops + 20, what="the answers to it")
    refused = base.clear()
    assert refused.code == 2
    assert "stays stopped" in refused.log
    assert base.speeds("0.5") == base.passed


def assert_cleared_without_the_rogue(base):
    base.rogue.stop()
    wait_for(base.is_cleared, what="the guard's leave to drive again")
    wait_for(lambda: base.speeds("0.5") > base.passed + 5, what="navigation again")


def test_an_intrusion_outlives_the_process_of_the_audit(base):
    """Long: the next bulk process discovers the domain anew, and a person asks twice."""
    bulk = process(base, "the bulk process is there")
    os.kill(bulk, signal.SIGKILL)
    wait_for(lambda: "the bulk process is gone" in base.guard.log, what="its loss")
    assert_stopped(base)
    wait_for(lambda: base.guard.log.count(COMPLETE) == 2, what="the next audit")
    assert process(base, "the bulk process is there") != bulk
    assert_stopped(base)
    assert_cleared_without_the_rogue(base)
    assert len(base.alarms("alarm: intrusion")) == 1
    assert [line for line in base.alarms() if ": impostor:" in line] == []
    assert base.guard.log.count("the guard begins") == 1


@pytest.mark.long
def test_a_guard_that_begins_beside_an_intruder_is_stopped_and_not_cleared(base):
    os.kill(process(base, "the guard begins"), signal.SIGKILL)
    wait_for(lambda: len(base.alarms("alarm: intrusion")) > 1, what="the next guard's alarm")
    wait_for(lambda: base.guard.log.count(COMPLETE) == 2, what="the audit's findings")
    assert_stopped(base)
    assert_cleared_without_the_rogue(base)
    assert [line for line in base.alarms() if ": impostor:" in line] == []


@pytest.mark.long
def test_nothing_is_cleared_while_no_audit_is_there(base):
    base.rogue.stop()
    wait_for(lambda: base.alarms("no more:"), what="the end of the alarm")
    stops = base.speeds("0.0")
    wait_for(lambda: base.speeds("0.0") > stops + 30, what="the stop that goes on")
    os.kill(process(base, "the bulk process is there"), signal.SIGKILL)
    wait_for(lambda: "the bulk process is gone" in base.guard.log, what="its loss")
    refused = base.ask_to_clear()
    assert "the audit is not connected: nobody knows" in refused["error"]
    assert base.speeds("0.5") == base.passed
    wait_for(base.is_cleared, what="the guard's leave to drive again")
    wait_for(lambda: base.speeds("0.5") > base.passed + 5, what="navigation again")


@pytest.mark.long
def test_a_robot_without_an_audit_is_stopped_until_there_is_one(calm):
    """The bulk process ends as soon as it begins, until the robot rests."""
    unseen = "unseen: /cmd_vel: nobody has looked for intruders for 10 s: "

    def is_stopped():
        with suppress(ProcessLookupError):
            os.kill(process(calm, "the bulk process is there"), signal.SIGKILL)
        return calm.alarms(f"alarm: {unseen}")

    wait_for(is_stopped, what="the end of the guard's patience")
    wait_for(lambda: calm.speeds("0.0") > 0, what="the stop")
    passed = calm.speeds("0.5")
    wait_for(lambda: calm.alarms(f"no more: {unseen}"), what="an audit")
    wait_for(lambda: calm.speeds("0.5") > passed, what="navigation again")
    assert not calm.alarms("alarm: intrusion")


@pytest.mark.long
def test_a_supervisor_that_was_killed_is_no_intruder_to_the_next_guard(calm):
    """Its participant, which spoke on the private output, is in the graph until its lease ends."""
    guard = process(calm, "the guard begins")
    os.kill(calm.guard.pid, signal.SIGKILL)
    wait_for(lambda: not lives(guard), what="the end of the guard")
    calm.start_guard()
    heard = calm.speeds("0.5")
    wait_for(lambda: calm.speeds("0.5") > heard + 150, what="navigation, some looks long")
    kinds = (": impostor:", ": ghost publisher:", ": foreign publisher:", ": intrusion:")
    assert [line for line in calm.alarms() if any(each in line for each in kinds)] == []
