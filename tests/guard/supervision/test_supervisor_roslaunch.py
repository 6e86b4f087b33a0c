"""The guard and its supervisor as roslaunch starts them, respawns one of them, and ends them."""

import os
import signal
from pathlib import Path

import pytest
from driven_base import Driven, drive_plan, write_app
from harness import lives, wait_for

from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

pytestmark = pytest.mark.ros1


@pytest.fixture
def launched(ros1, driver):
    """Start the base, instrumented, with roslaunch; yield that process and the driver's words."""
    launch = write_app(ros1.folder, driver)
    plan, out = ros1.folder / "rtron.yaml", ros1.folder / "guarded" / "base.launch"
    plan.write_text(write_plan(drive_plan()))
    driven = Driven(ros1.folder / "driven.txt")
    argument = f"out:={driven.path}"
    instrumented = ros1.rtron("instrument", launch, argument, "--plan", plan, "-o", out)
    wait_for(lambda: instrumented.ended, what="rtron instrument")
    roslaunch = ros1.spawn("roslaunch", out, argument)
    wait_for(driven.navigation, what="navigation at the driver")
    ros1.wait_for_nodes(GUARD_NODE, SUPERVISOR_NODE)
    return roslaunch, driven


def pid_of(ros1, node):
    return ros1.ask(ros1.uri_of(node), "getPid")


def parent(pid):
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


@pytest.mark.long
def test_after_its_supervisor_was_killed_roslaunch_starts_all_anew(ros1, launched):
    roslaunch, driven = launched
    guard, supervisor = pid_of(ros1, GUARD_NODE), pid_of(ros1, SUPERVISOR_NODE)
    assert parent(supervisor) == roslaunch.pid
    os.kill(supervisor, signal.SIGKILL)

    def respawned():
        found = pid_of(ros1, SUPERVISOR_NODE)
        return found not in (None, supervisor) and lives(found) and parent(found) == roslaunch.pid

    wait_for(respawned, what="roslaunch's new supervisor")
    passed = len(driven.navigation())
    wait_for(lambda: len(driven.navigation()) > passed + 20, what="navigation again")
    assert not lives(guard)
    again = pid_of(ros1, GUARD_NODE), pid_of(ros1, SUPERVISOR_NODE)
    roslaunch.stop()
    wait_for(lambda: not any(map(lives, again)), what="the end of what it started")


@pytest.mark.long
def test_a_guard_that_is_killed_comes_back_and_ends_with_roslaunch(ros1, launched):
    roslaunch, _ = launched
    guard, supervisor = pid_of(ros1, GUARD_NODE), pid_of(ros1, SUPERVISOR_NODE)
    os.kill(guard, signal.SIGKILL)
    wait_for(lambda: pid_of(ros1, GUARD_NODE) not in (None, guard), what="the next guard")
    again = pid_of(ros1, GUARD_NODE)
    forks = parent(again)
    assert parent(forks) == supervisor
    roslaunch.stop()
    assert not any(map(lives, (again, forks, supervisor)))
