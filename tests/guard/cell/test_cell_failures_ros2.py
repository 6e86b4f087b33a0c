"""What dies around a cell of ROS 2: without a guard the robot stops, and drives on later."""

import os
import re
import signal
from pathlib import Path

import pytest
from celled_base import is_guarded, needs_cell, needs_open_packages
from harness import lives, wait_for

pytest.importorskip("rclpy", reason="needs ROS 2")
from celled_base2 import CelledBase2, children, ros2_in_open_folder

pytestmark = [pytest.mark.ros2, needs_cell, needs_open_packages]


@pytest.fixture
def base2(own_runtime_folder):
    with ros2_in_open_folder() as ros2:
        base = CelledBase2(ros2)
        base.navigate()
        base.wait_for_more()
        yield base


def programs_in(base, name):
    """Return the processes of the cell that run a program."""
    (unshare,) = children(base.cell.pid)
    (init,) = children(unshare)
    lines = {pid: Path(f"/proc/{pid}/cmdline").read_bytes().decode() for pid in children(init)}
    return {pid for pid, line in lines.items() if name in line}


def connected_carrier(base, role):
    """Return the carrier of the guard or the supervisor: who has told its role.

    The role is the first thing that a client says; carriers log it with their process.
    """
    said = re.findall(rf"carrier (\d+): {role}", base.cell.log)
    inside = {inner_pid(pid): pid for pid in programs_in(base, "run_carrier")}
    return inside[int(said[-1])]


def inner_pid(pid):
    status = Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"^NSpid:.*\s(\d+)$", status, re.MULTILINE)[1])


def test_the_robot_stops_when_guard_and_supervisor_are_killed(base2):
    base2.guard.kill()
    wait_for(base2.stands, what="the stop in the cell")
    assert "nobody guards the cell any more" in base2.cell.log
    base2.start_guard()
    wait_for(base2.drives, what="navigation again")
    base2.wait_for_more()


@pytest.mark.long
def test_the_robot_stops_when_guard_and_supervisor_are_frozen(base2):
    base2.guard.tell(signal.SIGSTOP)
    wait_for(base2.stands, what="the stop in the cell")
    base2.guard.tell(signal.SIGCONT)
    wait_for(base2.drives, what="navigation again")


@pytest.mark.long
def test_the_supervisor_stops_the_robot_when_only_the_guard_is_killed(base2):
    process = int(re.findall(r"the guard begins, process (\d+)", base2.guard.log)[-1])
    os.kill(process, signal.SIGKILL)
    wait_for(lambda: "is gone: the robot is stopped" in base2.guard.log, what="the supervisor")
    wait_for(lambda: is_guarded(base2.cell.log), what="a supervisor that the stopper hears")
    base2.wait_for_more()


@pytest.mark.long
def test_the_robot_stops_when_the_carrier_of_the_guard_is_killed_and_drives_on_with_another(base2):
    os.kill(connected_carrier(base2, "guard"), signal.SIGKILL)
    wait_for(lambda: "nobody guards the cell any more" in base2.cell.log, what="the stop")
    wait_for(base2.drives, what="navigation again")
    base2.wait_for_more()
    assert "is gone: the robot is stopped" not in base2.guard.log  # the guard itself lives


@pytest.mark.long
def test_the_robot_stops_when_the_carrier_is_frozen_which_says_nothing_old_afterwards(base2):
    frozen = connected_carrier(base2, "guard")
    os.kill(frozen, signal.SIGSTOP)
    wait_for(lambda: "nobody guards the cell any more" in base2.cell.log, what="the stop")
    base2.wait_for_more()
    end = len(base2.messages())
    os.kill(frozen, signal.SIGCONT)
    wait_for(lambda: not lives(frozen), what="the end of the carrier that was frozen")
    base2.assert_undisturbed(end)


@pytest.mark.long
def test_commands_go_on_without_the_second_stopper_which_comes_back(base2):
    (stopper,) = programs_in(base2, "run_stopper")
    since = len(base2.messages())
    os.kill(stopper, signal.SIGKILL)
    wait_for(lambda: "run_stopper in the cell has ended" in base2.cell.log, what="its end")
    wait_for(lambda: base2.cell.log.count("a guard guards the cell") == 2, what="the next one")
    base2.assert_undisturbed(since)
    base2.guard.kill()
    wait_for(base2.stands, what="the stop in the cell")


@pytest.mark.long
def test_a_cell_ends_with_its_gateway_and_the_next_one_is_found(base2):
    inside = [*programs_in(base2, "run_carrier"), *programs_in(base2, "base.py")]
    base2.cell.kill()
    wait_for(lambda: not any(map(lives, inside)), what="the end of the cell")
    base2.restart_cell()
    base2.wait_for_more()
