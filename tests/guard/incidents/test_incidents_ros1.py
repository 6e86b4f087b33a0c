"""Incidents of a guard between real nodes of ROS 1."""

import os
import re
import signal
from pathlib import Path

import pytest
from driven_base import CMD_VEL_GUARD, Driven, start_guard
from guarded_drive import ALLOWED, FAST, speed_plan
from harness import NODES, ROS_PYTHON, lives, wait_for
from incident_checks import (
    CMD,
    check_limited_drive,
    check_messages_are_their_schemas,
    incidents_of,
    kinds_of,
    wait_for_incident,
)
from rostopic import TWIST, say

from rtron.guard.supervision import programs
from rtron.guard.supervision.programs import process_name
from rtron.guard.system.state_folder import INCIDENTS, state_folder
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import SECOND
from rtron.workflows.incidents import read_account
from rtron.workflows.what_if import as_it_was, without_guard

pytestmark = pytest.mark.ros1
OUT = f"/rtron{CMD}/out"


class LimitedBase:
    """A driver that /teleop drives too fast, behind a guard of an app of the test's own."""

    def __init__(self, ros1, app, **incidents):
        self.ros1, self.app = ros1, app
        self.driven = Driven(ros1.folder / "driven.txt")
        self.guard = start_guard(ros1, speed_plan(app, **incidents), CMD_VEL_GUARD)
        driver = [ROS_PYTHON, NODES / "driver.py", self.driven.path, "__name:=base"]
        ros1.spawn(*driver, f"{CMD}:={OUT}")
        ros1.wait_for_nodes("/base")

    def drive(self, speed=FAST, rate=20):
        remap = f"{CMD}:=/rtron{CMD}/flow1"
        teleop = say(self.ros1, "teleop", CMD, "geometry_msgs/Twist", TWIST % speed, rate, remap)
        allowed = min(speed, ALLOWED)
        wait_for(lambda: self.count_at(allowed) > rate, what="a second at the base")
        return teleop

    def count_at(self, speed):
        return [float(x) for x, _ in self.driven.messages()].count(speed)

    def pid_of(self, process):
        found = re.findall(rf"{process} is there, process (\d+)", self.guard.log)
        return int(found[-1])

    @property
    def fork_server(self):
        stat = Path(f"/proc/{self.pid_of('the bulk process')}/stat").read_text()
        return int(stat.rpartition(")")[2].split()[1])

    def recorders(self):
        """Return the processes that record, which the guard's fork server has started."""
        server = self.fork_server
        forks = map(int, Path(f"/proc/{server}/task/{server}/children").read_text().split())
        name = process_name(programs.INCIDENTS)
        return [pid for pid in forks if Path(f"/proc/{pid}/comm").read_text().strip() == name]


def test_a_drive_that_is_too_fast_is_an_incident_with_all_that_decided_it(ros1):
    base = LimitedBase(ros1, "incident_fast")
    base.drive()
    path = wait_for_incident(base.app)
    check_limited_drive(path, 1, "/teleop")
    check_messages_are_their_schemas(path, 1)
    opened = IncidentFile(path)
    account = read_account(opened)
    assert {each.speed for _, each in without_guard(account).outputs[CMD]} == {FAST}
    assert max(each.speed for _, each in as_it_was(opened).outputs[CMD]) == ALLOWED


@pytest.mark.long
def test_an_intruder_at_200_hz_is_one_incident_and_its_messages_are_in_it(ros1):
    base = LimitedBase(ros1, "incident_flood", keep=4 * SECOND)
    base.drive(0.1)
    ros1.node("rogue.py", "/by_hand", "200")
    path = wait_for_incident(base.app)
    account = read_account(IncidentFile(path))
    assert [each for each in account.header.causes if each.reason.startswith("drop: unapproved")]
    assert account.topics[CMD].verdicts["unapproved", "drop"] > 20
    assert len(account.topics[CMD].commands["unapproved"]) > 20
    rest = base.count_at(0.1)
    wait_for(lambda: base.count_at(0.1) > rest + 160, what="eight more seconds of the flood")
    assert [each for each in incidents_of(base.app) if "intervention" in kinds_of(each)] == [path]


def test_an_alarm_is_an_incident(ros1):
    base = LimitedBase(ros1, "incident_alarm")
    base.drive(0.1)
    ros1.node("rogue.py", "/ghost", "20", f"{CMD}:={OUT}")
    account = read_account(IncidentFile(wait_for_incident(base.app, "alarm", OUT)))
    assert account.header.gravest.kind == "alarm"
    assert any("/ghost" in event.reason for event in account.events if event.kind == "alarm")
    assert account.topics[CMD].output[-1][1].speed == 0


@pytest.mark.long
def test_a_killed_bulk_process_takes_the_minute_before_with_it_to_nobody(ros1):
    base = LimitedBase(ros1, "incident_killed")
    teleop = base.drive(0.1)
    ring = state_folder(base.app) / INCIDENTS / "ring"
    wait_for(lambda: any(each.stat().st_size > 10_000 for each in ring.glob("*")), what="the ring")
    bulk = base.pid_of("the bulk process")
    os.kill(bulk, signal.SIGKILL)
    wait_for(lambda: base.pid_of("the bulk process") != bulk, what="the next bulk process")
    wait_for(lambda: len(list(ring.glob("*"))) > 1, what="the next segment")
    teleop.kill()
    path = wait_for_incident(base.app, "stop")
    speeds = [each.speed for _, each in read_account(IncidentFile(path)).topics[CMD].output]
    assert 0 in speeds[speeds.index(0.1) :]


@pytest.mark.long
def test_a_guard_that_ends_leaves_no_recorder_behind(ros1):
    base = LimitedBase(ros1, "incident_end", after=60 * SECOND)
    base.drive()
    (recorder,) = base.recorders()
    base.guard.stop()
    assert not lives(recorder)
    check_limited_drive(wait_for_incident(base.app), 1, "/teleop")
    start_guard(ros1, speed_plan(base.app), CMD_VEL_GUARD)


@pytest.mark.long
def test_what_has_begun_is_saved_where_all_that_was_forked_is_killed(ros1):
    base = LimitedBase(ros1, "incident_forks", after=60 * SECOND)
    base.drive()
    assert base.recorders()
    os.kill(base.fork_server, signal.SIGKILL)
    check_limited_drive(wait_for_incident(base.app), 1, "/teleop")


@pytest.mark.long
def test_nothing_is_recorded_where_the_plan_says_so(ros1):
    base = LimitedBase(ros1, "incident_off", keep=0)
    base.drive()
    assert base.recorders() == []
    assert not (state_folder(base.app) / INCIDENTS).exists()
