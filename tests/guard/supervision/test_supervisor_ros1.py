"""The guard dies, hangs and starves between real nodes, and so does its supervisor."""

import os
import re
import resource
import signal
import sys
import time
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import pytest
from driven_base import CMD_VEL_GUARD, PATIENCE, Driven, drive_plan, start_guard
from harness import SOURCE, free_port, lives, named, wait_for
from log_lines import assert_each_has_a_time
from rostopic import TWIST, say

from rtron.guard.supervision.delivery_watch import ECHO_TOPIC
from rtron.guard.supervision.programs import JOB_CONTROL_SIGNALS, TERMINATION_SIGNALS
from rtron.guard.supervision.watchdog import HANG_TIMEOUT
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import GUARD_NODE, SECOND, SUPERVISOR_NODE, Plan, Supervision
from rtron.wire.ros1.xmlrpc import ros_call

pytestmark = pytest.mark.ros1
SPEED, FORBIDDEN = 0.8, 9.0
OUT = "/rtron/cmd_vel/out"


def plan_with_a_blocked_flow():
    plan = drive_plan()
    (node,) = plan.grcn
    mover, blocked = node.flows
    return replace(plan, grcn=(replace(node, flows=(mover, replace(blocked, block=True))),))


class Supervised:
    """A guard under supervision, and the driver behind it; a forbidden velocity flows too."""

    def __init__(self, ros1, driver, plan=None, lower=FORBIDDEN, *options):
        self.ros1 = ros1
        self.process = start_guard(
            ros1, plan or plan_with_a_blocked_flow(), CMD_VEL_GUARD, *options
        )
        self.plan = ros1.folder / "rtron.yaml"
        ros1.wait_for_nodes(GUARD_NODE, SUPERVISOR_NODE)
        self.driven = Driven(ros1.folder / "driven.txt")
        ros1.spawn(driver, self.driven.path, f"/cmd_vel:={OUT}", "__name:=driver")
        wait_for(self.is_wired, what="the driver's connections")
        twist = "geometry_msgs/Twist"
        flow1, flow2 = (f"/cmd_vel:=/rtron/cmd_vel/{flow}" for flow in ("flow1", "flow2"))
        self.nav = say(ros1, "nav", "/cmd_vel", twist, TWIST % SPEED, 50, flow1)
        self.wait_for_speed("the navigation")
        say(ros1, "rogue", "/cmd_vel", twist, TWIST % lower, 50, flow2)
        say(ros1, "by_hand", "/cmd_vel", twist, TWIST % FORBIDDEN, 50)
        self.wait_for_speed("the velocity")

    def is_wired(self):
        nodes = (SUPERVISOR_NODE, CMD_VEL_GUARD)
        return all(self.ros1.connected(node, "/driver", OUT) for node in nodes)

    @property
    def guard(self):
        return self.pid_of(GUARD_NODE)

    @property
    def supervisor(self):
        return self.pid_of(SUPERVISOR_NODE)

    def pid_of(self, node):
        return self.ros1.ask(self.ros1.uri_of(node), "getPid")

    @property
    def log(self):
        return self.process.log

    def speeds(self):
        return [float(x) for x, _ in self.driven.messages()]

    def wait_for_speed(self, what, since=0):
        wait_for(lambda: SPEED in self.speeds()[since:], what=what)

    def wait_for_stop(self, since=0):
        """Wait for a stop among what was told; return how much was told before it."""
        wait_for(lambda: any(x < SPEED for x in self.speeds()[since:]), what="the stop")
        return next(n for n, x in enumerate(self.speeds()) if n >= since and x < SPEED)

    def tell_guard(self, number):
        os.kill(self.guard, number)

    def assert_nothing_unchecked(self):
        assert max(self.speeds()) <= SPEED


@pytest.fixture
def supervised(ros1, driver):
    return Supervised(ros1, driver)


def parent(pid):
    return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])


def members(group):
    """Return the processes of a group that live."""
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit() and lives(int(folder.name)):
            try:
                same = os.getpgid(int(folder.name)) == group
            except ProcessLookupError:
                continue
            found += [int(folder.name)] if same else []
    return found


def signal_mask(pid, field):
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line.split()[1] for line in lines if line.startswith(field)), 16)


def starve(pid):
    size = int(Path(f"/proc/{pid}/statm").read_text().split()[0]) * resource.getpagesize()
    resource.prlimit(pid, resource.RLIMIT_AS, (size, size))


CAUSES = {
    "kill": lambda pid: os.kill(pid, signal.SIGKILL),
    "stop": lambda pid: os.kill(pid, signal.SIGSTOP),
    "starve": starve,
}


@pytest.mark.parametrize("cause", CAUSES)
def test_the_robot_is_stopped_and_the_guard_comes_back(supervised, cause):
    guard, told = supervised.guard, len(supervised.speeds())
    CAUSES[cause](guard)
    stopped = supervised.wait_for_stop(told)
    supervised.wait_for_speed("the velocity through the next guard", stopped)
    assert supervised.guard != guard
    assert not lives(guard)
    supervised.assert_nothing_unchecked()
    diagnostics = supervised.ros1.run("rostopic", "echo", "-n", "1", "/diagnostics")
    assert "guard: the guard before" in diagnostics


@pytest.mark.long
def test_the_lower_flow_does_not_go_first_after_a_restart(ros1, driver):
    plan = drive_plan()
    (node,) = plan.grcn
    patient = replace(plan, grcn=(replace(node, release_after=3 * PATIENCE),))
    supervised = Supervised(ros1, driver, patient, lower=0.3)
    high, told = supervised.nav, len(supervised.speeds())
    high.tell(signal.SIGSTOP)
    supervised.tell_guard(signal.SIGKILL)
    supervised.wait_for_stop(told)
    flow2 = "/rtron/cmd_vel/flow2"
    wait_for(lambda: ros1.received(CMD_VEL_GUARD, flow2) > 20, what="the lower flow at the guard")
    high.tell(signal.SIGCONT)
    supervised.wait_for_speed("the velocity through the next guard", told)
    assert 0.3 not in supervised.speeds()
    high.kill()
    wait_for(lambda: 0.3 in supervised.speeds(), what="the lower flow, now that nobody is higher")


def spare_of(supervised):
    """Return the guard that waits, once it is ready."""
    words = re.compile(r"the next guard is ready, process (\d+)")
    return int(wait_for(lambda: words.findall(supervised.process.log), what="a spare guard")[-1])


@pytest.mark.long
def test_a_supervisor_without_files_keeps_the_robot_stopped_and_starts_a_guard_later(supervised):
    supervisor, told = supervised.supervisor, len(supervised.speeds())
    spare, guard = spare_of(supervised), supervised.guard
    _, most = limit = resource.prlimit(supervisor, resource.RLIMIT_NOFILE)
    resource.prlimit(supervisor, resource.RLIMIT_NOFILE, (3, most))
    for pid in (spare, guard):
        os.kill(pid, signal.SIGKILL)
    wait_for(lambda: "no guard can be started" in supervised.process.log, what="the failure")
    stopped = supervised.wait_for_stop(told)
    wait_for(lambda: supervised.speeds()[-1] == 0, what="the rest")
    resource.prlimit(supervisor, resource.RLIMIT_NOFILE, limit)
    supervised.wait_for_speed("the velocity through the next guard", stopped)
    assert supervised.supervisor == supervisor


@pytest.mark.long
def test_a_spare_guard_that_has_ended_is_replaced_before_it_is_needed(supervised):
    spare = spare_of(supervised)
    os.kill(spare, signal.SIGKILL)
    wait_for(lambda: "ended while it waited" in supervised.process.log, what="the word of it")
    wait_for(lambda: spare_of(supervised) != spare, what="another spare guard")


@pytest.mark.long
def test_a_spare_guard_that_stands_still_is_soon_replaced(supervised):
    wait_for(lambda: "the next guard is ready" in supervised.process.log, what="a spare guard")
    spare, told = spare_of(supervised), len(supervised.speeds())
    os.kill(spare, signal.SIGSTOP)
    os.kill(supervised.guard, signal.SIGKILL)
    stopped = supervised.wait_for_stop(told)
    sooner_than_a_start_s = Supervision().start_within / SECOND * 0.9
    wait_for(lambda: not lives(spare), sooner_than_a_start_s, what="the end of the spare guard")
    supervised.wait_for_speed("the velocity through the next guard", stopped)


@pytest.mark.long
def test_guard_and_supervisor_log_with_times(ros1):
    process = start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
    texts = ("supervisor: the guard guards", "guarding 1 topics")
    wait_for(lambda: all(text in process.log for text in texts), what="what both say")
    assert_each_has_a_time(process.log, *texts)


def test_a_python_driver_is_stopped_too(ros1):
    start_guard(ros1, plan_with_a_blocked_flow(), CMD_VEL_GUARD)
    ros1.wait_for_nodes(GUARD_NODE, SUPERVISOR_NODE)
    echo = ros1.spawn("rostopic", "echo", "/cmd_vel/linear/x", "__name:=driver", f"/cmd_vel:={OUT}")
    wait_for(lambda: ros1.connected(SUPERVISOR_NODE, "/driver", OUT), what="the connection")
    twist = "geometry_msgs/Twist"
    say(ros1, "nav", "/cmd_vel", twist, TWIST % SPEED, 50, "/cmd_vel:=/rtron/cmd_vel/flow1")
    wait_for(lambda: "0.8" in echo.log, what="the velocity")
    guard = ros1.ask(ros1.uri_of(GUARD_NODE), "getPid")
    heard = [float(x) for x in echo.log.split() if x[0].isdigit()]
    os.kill(guard, signal.SIGKILL)
    wait_for(
        lambda: any(0 < float(x) < SPEED for x in echo.log.split() if x[0].isdigit()), what="a ramp"
    )
    assert set(heard) == {SPEED}


@pytest.mark.long
def test_a_short_stall_stops_the_robot_and_costs_the_guard_nothing(supervised):
    guard, told = supervised.guard, len(supervised.speeds())
    os.kill(guard, signal.SIGSTOP)
    stopped = supervised.wait_for_stop(told)
    os.kill(guard, signal.SIGCONT)
    supervised.wait_for_speed("the velocity", stopped)
    assert supervised.guard == guard
    supervised.assert_nothing_unchecked()


@pytest.mark.long
def test_who_stops_both_and_lets_both_go_on_gets_no_alarm(supervised):
    guard, told = supervised.guard, len(supervised.speeds())
    for number in (signal.SIGSTOP, signal.SIGCONT):
        supervised.process.tell(number)
    supervised.wait_for_speed("the velocity", told)
    assert supervised.guard == guard
    assert "stands still" not in supervised.process.log


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_a_guard_without_its_supervisor_stops_the_robot_and_ends(supervised, number):
    guard, group, told = supervised.guard, supervised.process.pid, len(supervised.speeds())
    os.kill(supervised.supervisor, number)
    supervised.wait_for_stop(told)
    wait_for(lambda: supervised.speeds()[-1] == 0.0, what="the rest")
    wait_for(lambda: members(group) == [], what="the end of all")
    assert not lives(guard)
    assert "the robot is stopped, and the guard ends; start rtron guard again" in supervised.log
    supervised.assert_nothing_unchecked()


def test_the_next_guard_begins_when_the_one_without_a_supervisor_has_ended(supervised):
    guard, told = supervised.guard, len(supervised.speeds())
    os.kill(supervised.supervisor, signal.SIGKILL)
    again = supervised.ros1.rtron("guard", "--plan", supervised.plan)
    stopped = supervised.wait_for_stop(told)
    supervised.wait_for_speed("the velocity through the next guard", stopped)
    assert not lives(guard)
    assert supervised.supervisor == again.pid
    supervised.assert_nothing_unchecked()
    again.stop()
    assert again.code == 0


@pytest.mark.parametrize("first", [GUARD_NODE, SUPERVISOR_NODE])
def test_the_robot_is_stopped_although_guard_and_supervisor_die_soon_after_each_other(
    supervised, first
):
    pids = {node: supervised.pid_of(node) for node in (GUARD_NODE, SUPERVISOR_NODE)}
    told = len(supervised.speeds())
    os.kill(pids.pop(first), signal.SIGKILL)
    supervised.wait_for_stop(told)
    (second,) = pids.values()
    with suppress(ProcessLookupError):
        os.kill(second, signal.SIGKILL)
    supervised.assert_nothing_unchecked()
    assert supervised.speeds()[-1] < SPEED


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_guard_ends_when_no_other_could_take_its_place(supervised, number):
    told = len(supervised.speeds())
    os.kill(parent(supervised.guard), number)
    supervised.wait_for_stop(told)
    wait_for(lambda: members(supervised.process.pid) == [], what="the end of all")
    wait_for(lambda: supervised.process.ended, what="the end of its last thread")
    assert supervised.process.code == os.EX_OSERR
    assert "what starts the guard's processes is gone" in supervised.log
    supervised.assert_nothing_unchecked()


def test_the_stop_does_not_wait_for_a_fork_server_that_hangs(supervised):
    guard, told = supervised.guard, len(supervised.speeds())
    os.kill(parent(guard), signal.SIGSTOP)
    os.kill(guard, signal.SIGKILL)
    killed_at = time.monotonic()
    supervised.wait_for_stop(told)
    wait_for(lambda: supervised.speeds()[-1] == 0.0, what="the rest")
    assert time.monotonic() - killed_at < HANG_TIMEOUT / SECOND, "it was killed first"
    wait_for(lambda: members(supervised.process.pid) == [], what="the end of all")
    assert "ran out of memory" not in supervised.log


def test_a_dry_run_without_its_supervisor_stops_the_robot_too(ros1, driver):
    supervised = Supervised(ros1, driver, drive_plan(), SPEED, "--dry-run")
    told = len(supervised.speeds())
    os.kill(supervised.supervisor, signal.SIGKILL)
    supervised.wait_for_stop(told)
    wait_for(lambda: supervised.speeds()[-1] == 0.0, what="the rest")


@pytest.mark.long
def test_a_guard_that_hangs_without_its_supervisor_is_killed_by_the_next_which_stops_the_robot(
    supervised,
):
    guard, supervisor = supervised.guard, supervised.supervisor
    for pid in (supervisor, guard):
        os.kill(pid, signal.SIGSTOP)
    supervised.nav.tell(signal.SIGSTOP)
    told = len(supervised.speeds())
    os.kill(supervisor, signal.SIGKILL)
    again = supervised.ros1.rtron("guard", "--plan", supervised.plan)
    wait_for(lambda: not lives(guard), what="the end of the guard that hangs")
    stopped = supervised.wait_for_stop(told)
    assert supervised.speeds()[stopped] == 0.0, "nobody knows how fast it was"
    supervised.nav.tell(signal.SIGCONT)
    supervised.wait_for_speed("the velocity through the next guard", stopped)
    again.stop()


def test_the_robot_is_stopped_while_nothing_comes_out_of_the_guard(supervised):
    """The master forgets the guard's echo whenever the guard tells it again: the guard beats on."""
    guard, log = supervised.guard, lambda: supervised.process.log
    wait_for(lambda: "its delivery is watched" in log(), what="the first ping")
    told = len(supervised.speeds())
    master, uri = supervised.ros1.uri, supervised.ros1.uri_of(GUARD_NODE)

    def is_stopped():
        ros_call(master, "unregisterPublisher", GUARD_NODE, ECHO_TOPIC, uri, timeout=10)
        return any(x < SPEED for x in supervised.speeds()[told:])

    wait_for(is_stopped, what="the stop")
    wait_for(lambda: "does not deliver: the robot is stopped" in log(), what="the reason")
    alarm = "alarm: guard: what goes into the guard does not come out in time"
    wait_for(lambda: alarm in log(), what="the alarm")
    wait_for(lambda: 0.0 in supervised.speeds()[told:], what="rest")
    supervised.wait_for_speed("the velocity, delivered again", len(supervised.speeds()))
    assert supervised.guard == guard
    supervised.assert_nothing_unchecked()


def test_a_second_guard_is_refused(supervised):
    guard, supervisor = supervised.guard, supervised.supervisor
    second = supervised.ros1.rtron("guard", "--plan", supervised.plan)
    wait_for(lambda: second.ended, what="the end of the second")
    assert second.code == 2
    running = f"error: a guard is running on {supervised.ros1.uri}, process {supervisor}"
    assert running in second.log
    assert supervised.guard == guard


@pytest.mark.parametrize(
    ("send", "number"),
    [(os.killpg, each) for each in TERMINATION_SIGNALS] + [(os.kill, signal.SIGTERM)],
)
def test_all_end_in_order_and_the_robot_is_stopped(supervised, send, number):
    """A terminal tells the whole group, systemd the first process."""
    wait_for(lambda: "the bulk process is there" in supervised.process.log, what="all processes")
    group, told = supervised.process.pid, len(supervised.speeds())
    send(group, number)
    wait_for(lambda: supervised.process.ended, what="the end")
    assert supervised.process.code == 0
    assert members(group) == []
    supervised.wait_for_stop(told)
    wait_for(lambda: supervised.speeds()[-1] == 0.0, what="the rest")
    assert not supervised.ros1.publishers(OUT)
    assert " ERROR " not in supervised.process.log
    assert "Traceback" not in supervised.process.log


def test_no_process_of_the_guard_is_frozen_from_a_terminal(supervised):
    wait_for(lambda: "the next guard is ready" in supervised.log, what="all processes")
    wait_for(lambda: "the bulk process is there" in supervised.log, what="the bulk process")
    bits = sum(1 << (number - 1) for number in JOB_CONTROL_SIGNALS)
    for pid in members(supervised.process.pid):
        unheard = signal_mask(pid, "SigIgn") | signal_mask(pid, "SigBlk")
        assert unheard & bits == bits, Path(f"/proc/{pid}/comm").read_text()


def test_the_end_of_a_terminal_that_was_ignored_before_ends_nothing(ros1):
    """As nohup(1) does."""
    path = ros1.folder / "rtron.yaml"
    path.write_text(write_plan(drive_plan()))
    command = (sys.executable, "-m", "rtron", "guard", "--plan", path)
    ran = ros1.spawn("nohup", *command, PYTHONPATH=str(SOURCE))
    ros1.wait_for_nodes(GUARD_NODE, SUPERVISOR_NODE)
    assert signal_mask(ran.pid, "SigIgn") & 1 << (signal.SIGHUP - 1)
    ran.stop()
    assert ran.code == 0


@pytest.mark.parametrize("closed", [0, 1, 2])
def test_a_guard_guards_whichever_standard_file_is_closed(ros1, closed):
    path = ros1.folder / "rtron.yaml"
    path.write_text(write_plan(drive_plan()))
    command = (sys.executable, "-m", "rtron", "guard", "--plan", path)
    close = f'exec "$@" {closed}>&-'
    ran = ros1.spawn("sh", "-c", close, "sh", *command, PYTHONPATH=str(SOURCE))
    ros1.wait_for_nodes(GUARD_NODE, SUPERVISOR_NODE)
    for node in (GUARD_NODE, SUPERVISOR_NODE):
        pid = ros1.ask(ros1.uri_of(node), "getPid")
        assert Path(f"/proc/{pid}/fd/{closed}").samefile(os.devnull)
    ran.stop()
    assert ran.code == 0
    assert "Traceback" not in ran.log


@pytest.mark.long
def test_a_guard_that_hangs_does_not_keep_the_supervisor_from_ending(supervised):
    group = supervised.process.pid
    supervised.tell_guard(signal.SIGSTOP)
    os.kill(group, signal.SIGTERM)
    wait_for(lambda: supervised.process.ended, what="the end")
    assert supervised.process.code == 0
    assert members(group) == []


@pytest.mark.long
@pytest.mark.parametrize("node", [GUARD_NODE, CMD_VEL_GUARD])
def test_no_node_of_the_guard_is_ended_over_the_network(supervised, node):
    guard, told = supervised.guard, len(supervised.speeds())
    supervised.ros1.run("rosnode", "kill", node)
    refused = f"{node} is not shut down, end rtron guard itself"
    wait_for(lambda: refused in supervised.process.log, what="the refusal")
    supervised.wait_for_speed("the velocity", told)
    assert supervised.guard == guard
    assert set(supervised.speeds()) == {SPEED}
    assert supervised.ros1.connected(CMD_VEL_GUARD, "/driver", OUT)


@pytest.mark.long
def test_a_flood_of_shutdowns_is_no_flood_of_log_lines(supervised):
    before = len(supervised.process.log)
    for node in (GUARD_NODE, SUPERVISOR_NODE):
        uri = supervised.ros1.uri_of(node)
        for _ in range(100):
            supervised.ros1.ask(uri, "shutdown", "\n" + "x" * 10_000)
        wait_for(lambda node=node: f"{node} " in supervised.process.log[before:], what="a refusal")
    assert len(supervised.process.log) - before < 10_000


def test_the_supervisor_is_not_ended_over_the_network(supervised):
    supervisor = supervised.supervisor
    supervised.ros1.run("rosnode", "kill", SUPERVISOR_NODE)
    assert supervised.supervisor == supervisor
    told = len(supervised.speeds())
    supervised.tell_guard(signal.SIGKILL)
    supervised.wait_for_stop(told)


@pytest.mark.long
def test_nothing_is_left_when_both_are_killed(supervised):
    group = supervised.process.pid
    for number in (supervised.supervisor, supervised.guard):
        os.kill(number, signal.SIGKILL)
    wait_for(lambda: members(group) == [], what="the end of all")


@pytest.mark.skipif(find_spec("rclpy") is not None, reason="ROS 2 is here")
def test_a_plan_for_ros_2_is_refused_where_there_is_none(ros1):
    path = ros1.folder / "two.yaml"
    path.write_text(write_plan(Plan(app="two", ros=2)))
    ran = ros1.rtron("guard", "--plan", path)
    wait_for(lambda: ran.ended, what="the end")
    assert ran.code == 2
    assert "error: ROS 2 is not there" in ran.log
    assert "help: " in ran.log


def test_a_door_that_cannot_be_opened_is_refused(ros1):
    path = ros1.folder / "rtron.yaml"
    path.write_text(write_plan(drive_plan()))
    door = ros1.folder / "none" / "deeper" / "door.sock"
    ran = ros1.rtron("guard", "--plan", path, "--control-socket", door)
    wait_for(lambda: ran.ended, what="the end")
    assert ran.code == 2
    assert f"error: {door}: No such file or directory" in ran.log
    assert "help: choose --control-socket PATH" in ran.log
    assert members(ran.pid) == []


def test_a_master_that_is_not_there_is_waited_for(ros1):
    path = ros1.folder / "rtron.yaml"
    path.write_text(write_plan(drive_plan()))
    master = f"http://localhost:{free_port()}"
    ran = ros1.rtron("guard", "--plan", path, "--master", master, *named("/rtron_guard"))
    wait_for(lambda: "does not answer" in ran.log, what="the wait")
    ran.stop()
    assert ran.code == 0
