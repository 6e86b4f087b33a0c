"""Which of several participants with one name still live: what may and may not be concluded."""

import os
import subprocess
import sys

import pytest

from rtron.guard.transport.ros2.lives import (
    LEASE,
    Life,
    Lives,
    find_process,
    process_lives,
    process_of,
)
from rtron.vocabulary import SECOND

HERE = b"\x01\x0f\x78\xfd"
ELSEWHERE = b"\x01\x0f\x11\x22"
OTHER_VENDOR = b"\x01\x10\x78\xfd"


def participant(low, host=HERE, more=0):
    return host + low.to_bytes(2, "little") + more.to_bytes(6, "big")


OWN = participant(1)
OLD, NEW, FAR = participant(2), participant(3), participant(4, ELSEWHERE)


class Processes:
    """The processes of a machine, by the lower half of their ids."""

    def __init__(self, *running):
        self.running = {low: (low, 7) for low in running}

    def lives(self, own=OWN):
        return Lives(own, self.running.get, lambda process: process in self.running.values())


@pytest.fixture
def processes():
    return Processes(1, 2, 3)


def test_a_process_that_was_seen_here_and_has_ended_is_gone(processes):
    lives = processes.lives()
    lives.look([OLD, NEW], 0)
    assert (lives.of(OLD), lives.of(NEW)) == (Life.RUNS, Life.RUNS)
    del processes.running[2]
    assert (lives.of(OLD), lives.of(NEW)) == (Life.GONE, Life.RUNS)
    assert lives.living([OLD, NEW]) == {NEW}


def test_another_process_with_the_same_id_is_not_the_one_that_was_seen(processes):
    lives = processes.lives()
    lives.look([OLD], 0)
    processes.running[2] = (2, 8)
    assert lives.of(OLD) is Life.GONE


@pytest.mark.parametrize(
    "unseen", [FAR, participant(2, OTHER_VENDOR), participant(9), participant(2, b"\0\0\x78\xfd")]
)
def test_who_was_never_seen_running_here_is_not_said_to_be_gone(processes, unseen):
    lives = processes.lives()
    lives.look([unseen], 0)
    processes.running.clear()
    assert lives.of(unseen) is Life.UNTOLD
    assert lives.living([unseen, NEW]) == {unseen, NEW}


def test_nothing_is_known_beside_another_middleware(processes):
    lives = processes.lives(own=participant(1, OTHER_VENDOR))
    lives.look([participant(2, OTHER_VENDOR)], 0)
    assert lives.of(participant(2, OTHER_VENDOR)) is Life.UNTOLD


def test_who_has_left_the_graph_is_forgotten_and_seen_anew(processes):
    lives = processes.lives()
    lives.look([OLD], 5)
    lives.look([], 6)
    assert (lives.since(OLD), lives.of(OLD)) == (0, Life.UNTOLD)
    lives.look([OLD], 7)
    assert lives.since(OLD) == 7


def test_a_single_one_has_its_name_even_when_its_process_has_ended(processes):
    lives = processes.lives()
    lives.look([OLD], 0)
    processes.running.clear()
    assert lives.living([OLD]) == {OLD}


class TestClash:
    def test_two_that_run_clash_at_once(self, processes):
        lives = processes.lives()
        lives.look([OLD], 0)
        assert not lives.clash([OLD], 0)
        lives.look([OLD, NEW], SECOND)
        assert lives.clash([OLD, NEW], SECOND)

    def test_one_that_was_killed_and_its_successor_do_not(self, processes):
        lives = processes.lives()
        lives.look([OLD], 0)
        del processes.running[2]
        lives.look([OLD, NEW], SECOND)
        assert not lives.clash([OLD, NEW], SECOND)
        assert not lives.clash([OLD, NEW], SECOND + 2 * LEASE)

    def test_one_elsewhere_that_comes_beside_one_that_runs_does(self, processes):
        lives = processes.lives()
        lives.look([OLD], 0)
        lives.look([OLD, FAR], SECOND)
        assert lives.clash([OLD, FAR], SECOND)

    def test_one_that_comes_in_the_place_of_one_elsewhere_does_when_a_lease_is_over(
        self, processes
    ):
        lives = processes.lives()
        lives.look([FAR], 0)
        lives.look([FAR, NEW], SECOND)
        assert not lives.clash([FAR, NEW], SECOND + LEASE - 1)
        assert lives.clash([FAR, NEW], SECOND + LEASE)

    def test_a_third_one_makes_no_difference_to_two_that_run(self, processes):
        lives = processes.lives()
        lives.look([OLD, FAR], 0)
        lives.look([OLD, FAR, NEW], SECOND)
        assert lives.clash([OLD, FAR, NEW], SECOND)


SLEEPS = "import sys, time; print('ready', flush=True); sys.stdin.read()"


def test_a_process_without_fast_dds_is_nobodys_participant():
    assert find_process(os.getpid() & 0xFFFF) is None or "rclpy" in sys.modules


def test_a_process_that_was_killed_lives_no_more_although_nobody_has_waited_for_it():
    lines = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with subprocess.Popen([sys.executable, "-c", SLEEPS], **lines) as process:
        process.stdout.readline()
        found = process_of(process.pid)
        assert found
        assert process_lives(found)
        assert not process_lives((process.pid, found[1] + 1))
        process.kill()
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        assert not process_lives(found)
    assert not process_lives(found)
