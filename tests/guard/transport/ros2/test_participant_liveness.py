"""Which of several participants with one name still live: what may and may not be concluded."""

import os
import subprocess
import sys

import pytest
from proc_folder import ANOTHER, LIBC, THEIR_NETWORK, ProcFolder

from rtron.guard.transport.ros2.participants import MAX_LEASE, ParticipantLiveness, ParticipantState
from rtron.guard.transport.ros2.process_table import ProcessTable
from rtron.vocabulary import SECOND

SOON = SECOND // 50
HERE = b"\x01\x0f\x78\xfd"
ELSEWHERE = b"\x01\x0f\x11\x22"
OTHER_VENDOR = b"\x01\x10\x78\xfd"


def participant(low, host=HERE, chance=0x2A2A, number=0):
    """Return a participant as Fast DDS names it: host, process, chance, and a number."""
    process = low.to_bytes(2, "little") + chance.to_bytes(2, "little")
    return host + process + number.to_bytes(4, "little")


OWN = participant(1001)
OLD, NEW, FAR = participant(1002), participant(1003), participant(1004, ELSEWHERE)


@pytest.fixture
def machine(tmp_path):
    machine = ProcFolder(tmp_path)
    for pid in (1001, 1002, 1003):
        machine.start(pid)
    return machine


@pytest.fixture
def lives(machine):
    return ParticipantLiveness(OWN, machine.processes())


def test_a_process_that_was_seen_here_and_has_ended_is_gone(machine, lives):
    lives.update([OLD, NEW], 0)
    assert (lives.state(OLD), lives.state(NEW)) == (
        ParticipantState.RUNNING,
        ParticipantState.RUNNING,
    )
    machine.end(1002)
    assert (lives.state(OLD), lives.state(NEW)) == (
        ParticipantState.ENDED,
        ParticipantState.RUNNING,
    )
    assert lives.not_ended([OLD, NEW]) == {NEW}


def test_another_process_with_the_same_id_is_not_the_one_that_was_seen(machine, lives):
    lives.update([OLD], 0)
    machine.start(1002, began=8)
    assert lives.state(OLD) is ParticipantState.ENDED


def test_of_a_process_id_only_the_lower_half_is_told(machine, lives):
    machine.start(0x30000 + 2002)
    lives.update([participant(2002)], 0)
    assert lives.process(participant(2002)) == (0x30000 + 2002, 7)
    machine.end(0x30000 + 2002)
    assert lives.state(participant(2002)) is ParticipantState.ENDED


@pytest.mark.parametrize(
    "unseen",
    [FAR, participant(1002, OTHER_VENDOR), participant(9), participant(1002, b"\0\0\x78\xfd")],
)
def test_who_was_never_seen_running_here_is_not_said_to_be_gone(machine, lives, unseen):
    lives.update([unseen], 0)
    machine.end(1002)
    assert lives.state(unseen) is ParticipantState.UNKNOWN
    assert lives.not_ended([unseen, NEW]) == {unseen, NEW}


class TestInheritance:
    """What a guard has seen for certain, the one after it knows, and nothing else."""

    def successor(self, machine, lives, *present):
        following = ParticipantLiveness(OWN, machine.processes())
        following.inherit(lives.certain_processes())
        following.update(present, 0)
        return following

    def test_a_process_that_ended_before_the_successor_came(self, machine, lives):
        lives.update([OLD, NEW], 0)
        machine.end(1002)
        following = self.successor(machine, lives, OLD, NEW)
        assert following.not_ended([OLD, NEW]) == {NEW}

    def test_its_id_given_to_another_process(self, machine, lives):
        lives.update([OLD, NEW], 0)
        machine.start(1002, began=8)
        assert self.successor(machine, lives, OLD).state(OLD) is ParticipantState.ENDED

    def test_who_is_not_discovered_yet_is_handed_on(self, machine, lives):
        lives.update([OLD, NEW], 0)
        following = self.successor(machine, lives, NEW)
        assert following.certain_processes() == lives.certain_processes()

    def test_what_was_in_doubt_is_not_inherited(self, machine, lives):
        rival = participant(1002, chance=0x1111)
        lives.update([OLD, rival], 0)
        machine.end(1002)
        following = self.successor(machine, lives, OLD, rival)
        assert following.state(OLD) is ParticipantState.UNKNOWN

    def test_a_rival_that_comes_later_takes_the_certainty(self, machine, lives):
        lives.update([OLD], 0)
        following = self.successor(machine, lives, OLD, participant(1002, chance=0x1111))
        machine.end(1002)
        assert following.state(OLD) is ParticipantState.UNKNOWN
        assert OLD not in following.certain_processes()


class TestCertainty:
    """Nobody who may be in a process that is not the one that has ended is said to be gone."""

    def told(self, machine, *others, pid=1002, processes=None):
        """Return what is said of an old participant when a process has ended."""
        lives = ParticipantLiveness(OWN, processes or machine.processes())
        lives.update([OLD, *others], 0)
        machine.end(pid)
        return lives.state(OLD)

    def test_a_process_in_a_container_that_calls_itself_the_same(self, machine):
        machine.start(4711, own=(1002,))
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_a_process_of_a_container_is_known_by_its_own_id(self, machine):
        machine.end(1002)
        machine.start(4711, own=(25, 1002))
        assert self.told(machine, pid=4711) is ParticipantState.ENDED

    def test_a_process_whose_id_ends_in_the_same_bits(self, machine):
        machine.start(0x10000 + 1002, maps=LIBC)
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_a_container_of_our_own_in_which_we_see_nobody_else(self, tmp_path):
        machine = ProcFolder(tmp_path, namespace=ANOTHER)
        machine.start(1002)
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_processes_that_are_hidden_from_us(self, machine):
        machine.end(1)
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_a_process_without_fast_dds(self, machine):
        machine.start(1002, maps=LIBC)
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_a_process_in_another_network_which_has_another_host_id(self, machine):
        machine.start(1002, network=THEIR_NETWORK)
        assert self.told(machine) is ParticipantState.UNKNOWN

    def test_two_with_different_chances_which_cannot_be_one_process(self, machine):
        other = participant(1002, chance=1)
        assert self.told(machine, other) is ParticipantState.UNKNOWN

    def test_who_contradicts_later_counts_as_much(self, machine, lives):
        lives.update([OLD], 0)
        assert lives.is_certain(OLD)
        lives.update([OLD, participant(1002, chance=1)], SOON)
        lives.update([OLD], 2 * SOON)
        machine.end(1002)
        assert lives.state(OLD) is ParticipantState.UNKNOWN

    def test_two_participants_of_one_process_do_not_contradict(self, machine):
        assert self.told(machine, participant(1002, number=1)) is ParticipantState.ENDED

    def test_who_came_after_the_last_look_is_found(self, machine, lives):
        lives.update([], 0)
        machine.start(2002)
        lives.update([participant(2002)], SOON)
        machine.start(4711, own=(2003,))
        machine.start(2003)
        lives.update([participant(2002), participant(2003)], 2 * SOON)
        assert lives.is_certain(participant(2002))
        assert lives.process(participant(2003)) is None

    def test_an_id_that_has_come_round_is_read_again(self, machine, lives):
        lives.update([], 0)
        machine.start(4711)
        lives.update([], SOON)
        machine.start(4711, own=(1002,), began=9)
        lives.update([OLD], 2 * SECOND)
        assert lives.process(OLD) is None


def test_a_process_whose_first_thread_has_ended_lives_with_the_others(machine, lives):
    lives.update([OLD], 0)
    machine.start(1002, state="Z", threads=2)
    assert lives.state(OLD) is ParticipantState.RUNNING
    machine.start(1002, state="Z", threads=1)
    assert lives.state(OLD) is ParticipantState.ENDED


def test_nobody_is_gone_where_it_cannot_be_read(machine, lives):
    lives.update([OLD], 0)
    (machine.proc / "1002/stat").unlink()
    (machine.proc / "1002/stat").mkdir()
    assert lives.state(OLD) is ParticipantState.RUNNING
    machine.proc.rename(machine.proc.with_name("elsewhere"))
    assert lives.state(OLD) is ParticipantState.UNKNOWN
    lives.update([OLD, NEW], SOON)
    assert lives.state(NEW) is ParticipantState.UNKNOWN


def test_a_crowd_of_newcomers_is_looked_for_bit_by_bit(machine, lives):
    crowd = [participant(n) for n in range(40)]
    lives.update([*crowd, OLD], 0)
    assert lives.state(OLD) is ParticipantState.UNKNOWN
    lives.update([*crowd, OLD], 1)
    assert lives.state(OLD) is ParticipantState.RUNNING


def test_nothing_is_known_beside_another_middleware(machine):
    lives = ParticipantLiveness(participant(1001, OTHER_VENDOR), machine.processes())
    lives.update([participant(1002, OTHER_VENDOR)], 0)
    assert lives.state(participant(1002, OTHER_VENDOR)) is ParticipantState.UNKNOWN


def test_who_has_left_the_graph_is_forgotten_and_seen_anew(lives):
    lives.update([OLD], 5)
    lives.update([], 6)
    assert (lives.since(OLD), lives.state(OLD)) == (0, ParticipantState.UNKNOWN)
    lives.update([OLD], 7)
    assert lives.since(OLD) == 7


def test_a_single_one_has_its_name_even_when_its_process_has_ended(machine, lives):
    lives.update([OLD], 0)
    machine.end(1002)
    assert lives.not_ended([OLD]) == {OLD}


class TestClash:
    def test_two_that_run_clash_at_once(self, lives):
        lives.update([OLD], 0)
        assert not lives.has_conflict([OLD], 0)
        lives.update([OLD, NEW], SECOND)
        assert lives.has_conflict([OLD, NEW], SECOND)

    def test_one_that_was_killed_and_its_successor_do_not(self, machine, lives):
        lives.update([OLD], 0)
        machine.end(1002)
        lives.update([OLD, NEW], SECOND)
        assert not lives.has_conflict([OLD, NEW], SECOND)
        assert not lives.has_conflict([OLD, NEW], SECOND + 2 * MAX_LEASE)

    def test_one_elsewhere_that_comes_beside_one_that_runs_does(self, lives):
        lives.update([OLD], 0)
        lives.update([OLD, FAR], SECOND)
        assert lives.has_conflict([OLD, FAR], SECOND)

    def test_one_that_comes_in_the_place_of_one_elsewhere_does_when_a_lease_is_over(self, lives):
        lives.update([FAR], 0)
        lives.update([FAR, NEW], SECOND)
        assert not lives.has_conflict([FAR, NEW], SECOND + MAX_LEASE - 1)
        assert lives.has_conflict([FAR, NEW], SECOND + MAX_LEASE)

    def test_a_third_one_makes_no_difference_to_two_that_run(self, lives):
        lives.update([OLD, FAR], 0)
        lives.update([OLD, FAR, NEW], SECOND)
        assert lives.has_conflict([OLD, FAR, NEW], SECOND)


SLEEPS = "import sys, time; print('ready', flush=True); sys.stdin.read()"


def test_a_process_without_fast_dds_is_nobodys_participant():
    processes = ProcessTable()
    processes.update(0)
    assert processes.find(os.getpid() & 0xFFFF) is None or "rclpy" in sys.modules


def test_a_process_that_was_killed_lives_no_more_although_nobody_has_waited_for_it():
    processes = ProcessTable()
    lines = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", SLEEPS], **lines) as process:
        process.stdout.readline()
        found = processes.process(process.pid)
        assert found
        assert processes.is_running(found)
        assert not processes.is_running((process.pid, found[1] + 1))
        process.kill()
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        assert not processes.is_running(found)
    assert not processes.is_running(found)
