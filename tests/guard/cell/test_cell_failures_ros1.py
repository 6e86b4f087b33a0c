"""What dies around a cell: the robot stops when nobody guards it, and drives on when one does."""

import os
import signal
from pathlib import Path

import pytest
from celled_base import STOP, celled_plan, is_guarded, needs_cell, start_cell
from driven_base import CMD_VEL_GUARD, start_guard
from harness import lives, wait_for

from rtron.planning.plan_file.writer import write_plan

pytestmark = [pytest.mark.ros1, needs_cell]


def children(pid):
    text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [int(child) for child in text.split()]


def processes_in(base):
    """Return the processes of the cell by the program that they run: `init` starts the others."""
    (unshare,) = children(base.cell.pid)
    (init,) = children(unshare)
    found = {"init": init}
    for pid in children(init):
        words = Path(f"/proc/{pid}/cmdline").read_bytes().decode()
        names = ("run_stopper", "run_cell_master", "driver")
        found |= {name: pid for name in names if name in words}
    return found


def stands(base):
    return base.driven.messages()[-1] == STOP


def is_turning_left(base):
    return base.driven.messages()[-1][1] == "0.5"


def test_the_robot_stops_when_guard_and_supervisor_are_killed(base):
    base.navigate()
    base.guard.kill()
    wait_for(lambda: stands(base), what="the stop in the cell")
    assert "nobody guards the cell any more" in base.cell.log
    base.guard = start_guard(base.ros1, base.plan, CMD_VEL_GUARD)
    wait_for(lambda: is_turning_left(base), what="navigation again")
    base.wait_for_more()


def test_the_robot_stops_when_guard_and_supervisor_are_frozen(base):
    base.navigate()
    base.guard.tell(signal.SIGSTOP)
    wait_for(lambda: stands(base), what="the stop in the cell")
    base.guard.tell(signal.SIGCONT)
    wait_for(lambda: is_turning_left(base), what="navigation again")


@pytest.mark.long
def test_the_supervisor_stops_the_robot_when_only_the_guard_is_killed(base):
    base.navigate()
    os.kill(base.ros1.ask(base.ros1.uri_of(CMD_VEL_GUARD), "getPid"), signal.SIGKILL)
    wait_for(lambda: "is gone: the robot is stopped" in base.guard.log, what="the supervisor")
    wait_for(lambda: is_guarded(base.cell.log), what="a supervisor that the stopper hears")
    base.wait_for_more()


@pytest.mark.long
def test_commands_go_on_without_the_second_stopper_which_comes_back(base):
    base.navigate()
    os.kill(processes_in(base)["run_stopper"], signal.SIGKILL)
    wait_for(lambda: "run_stopper in the cell has ended" in base.cell.log, what="its end")
    wait_for(lambda: "run_stopper" in processes_in(base), what="the next stopper")
    base.assert_undisturbed()
    base.guard.kill()
    wait_for(lambda: stands(base), what="the stop in the cell")


@pytest.mark.long
def test_commands_go_on_without_the_master_of_the_cell_which_comes_back(base):
    base.navigate()
    os.kill(processes_in(base)["run_cell_master"], signal.SIGKILL)
    wait_for(lambda: base.cell.log.count("the master proxy listens") == 2, what="the next master")
    base.assert_undisturbed()


@pytest.mark.long
def test_a_cell_ends_with_its_gateway_and_the_next_one_is_found(base):
    base.navigate()
    inside = processes_in(base)
    base.cell.kill()
    wait_for(lambda: not any(map(lives, inside.values())), what="the end of the cell")
    base.restart_cell()
    base.wait_for_more()


def test_a_cell_ends_with_its_node_and_tells_its_exit_code(open_ros1):
    start_plan(open_ros1)
    cell = start_cell(open_ros1, ["sh", "-c", "exit 7"])
    wait_for(lambda: cell.ended, what="the end of the cell")
    assert cell.code == 7


def test_a_signal_reaches_the_node_which_has_its_own_moment_to_end(open_ros1):
    start_plan(open_ros1)
    script = "trap 'echo told; exit 5' INT; echo begun; while :; do sleep 0.1; done"
    cell = start_cell(open_ros1, ["sh", "-c", script])
    wait_for(lambda: "begun" in cell.log, what="the node")
    cell.tell(signal.SIGINT)
    wait_for(lambda: cell.ended, what="the end of the cell")
    assert cell.code == 5
    assert "told" in cell.log


@pytest.mark.long
def test_a_second_cell_for_the_node_is_refused(base):
    second = start_cell(base.ros1, ["true"])
    wait_for(lambda: second.ended, what="the end of the second cell")
    assert second.code == 2
    assert "another cell" in second.log
    base.navigate()


def start_plan(ros1):
    (ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
