"""The process beside the guard is started again, more seldom if it ends at once."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import pytest
from harness import wait_for

from rtron.guard.supervision.helper_process import (
    MAX_RESTART_DELAY,
    MIN_RESTART_DELAY,
    HelperProcess,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, HANG_TIMEOUT, LONGEST_HANG, START_TIMEOUT
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.vocabulary import SECOND


@pytest.fixture
def order():
    reading, writing = os.pipe()
    yield reading
    os.close(reading)
    os.close(writing)


CODE = "import signal; signal.signal(signal.SIGTERM, lambda *_: exit(7)); signal.pause()"


class Started(subprocess.Popen):
    """A process as `ForkedProcess` is one."""

    def wait(self, timeout=None):
        with suppress(subprocess.TimeoutExpired):
            super().wait(timeout)
        return self.returncode is not None


class Starter:
    """Starts processes in the fork server's place: a test has several threads, and cannot fork."""

    def __init__(self, *command):
        self._command = command

    def start(self, program, files):
        return Started(self._command)


@pytest.fixture
def helper(order):
    helper = HelperProcess(Starter(sys.executable, "-c", CODE), order, "link_program:main")
    yield helper
    helper.stop(20)


def end(helper):
    helper.process.kill()
    helper.process.wait()


def handles(status):
    caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) & (1 << (signal.SIGTERM - 1))


def test_it_runs_once(helper):
    helper.tick(0)
    first = helper.process
    helper.tick(MAX_RESTART_DELAY)
    assert helper.process is first


def test_it_is_started_again_but_not_at_once(helper):
    helper.tick(0)
    first = helper.process
    end(helper)
    helper.tick(5)
    helper.tick(5 + MIN_RESTART_DELAY - 1)
    assert helper.process is first
    helper.tick(5 + MIN_RESTART_DELAY)
    assert helper.process is not first


def test_one_that_keeps_ending_is_tried_more_seldom(helper):
    starts, last = [], None
    for second in range(300):
        helper.tick(second * SECOND)
        if helper.process is not last:
            last = helper.process
            starts.append(second)
            end(helper)
    gaps = [after - before - 1 for before, after in pairwise(starts)]
    assert gaps[:3] == [1, 2, MAX_RESTART_DELAY // SECOND]
    assert set(gaps[3:]) == {MAX_RESTART_DELAY // SECOND}


def test_one_that_ran_for_long_is_started_again_soon(helper):
    now = 0
    for _ in range(4):
        helper.tick(now)
        end(helper)
        helper.tick(now := now + 1)
        now += MAX_RESTART_DELAY
    helper.tick(now)
    lasting = helper.process
    helper.tick(now := now + MAX_RESTART_DELAY)
    end(helper)
    helper.tick(now)
    assert helper.process is not lasting


class Watched:
    """A process that beats when the test says so, and the supervisor's looks at it."""

    def __init__(self, helper, beat):
        self.helper, self.beat = helper, beat
        self.now = 0
        helper.tick(0)
        self.process = helper.process

    def look_for(self, duration, *, beats=False):
        for _ in range(duration // BEAT_PERIOD):
            self.now += BEAT_PERIOD
            if beats and self.now % SharedBeat.PERIOD == 0:
                self.beat.at = self.now
            self.helper.tick(self.now)


@pytest.fixture
def watched(order):
    beat = SharedBeat.create()
    helper = HelperProcess(
        Starter(sys.executable, "-c", CODE), order, "link_program:main", beat=beat
    )
    yield Watched(helper, beat)
    helper.stop(20)


def test_one_that_beats_is_left_alone(watched):
    watched.look_for(SECOND, beats=True)
    watched.look_for(HANG_TIMEOUT - SECOND // 10)
    watched.look_for(3 * SECOND, beats=True)
    assert watched.helper.process is watched.process
    assert watched.process.poll() is None


def test_one_that_stands_still_is_killed_and_the_next_has_time_to_start(watched):
    watched.look_for(5 * SECOND, beats=True)
    watched.look_for(HANG_TIMEOUT + SECOND // 10)
    assert watched.process.wait(20)
    assert watched.process.poll() == -signal.SIGKILL
    watched.look_for(SECOND // 10)
    following = watched.helper.process
    assert following is not watched.process
    assert watched.beat.at == 0
    watched.look_for(START_TIMEOUT - SECOND)
    assert following.poll() is None
    watched.look_for(2 * SECOND)
    assert following.wait(20)


def test_one_that_is_late_again_and_again_has_longer(watched):
    for _ in range(5):
        watched.look_for(SECOND)
        watched.beat.at = watched.now
    watched.look_for(HANG_TIMEOUT + SECOND // 2)
    assert watched.process.poll() is None
    watched.look_for(LONGEST_HANG)
    assert watched.process.wait(20)


def test_it_is_told_to_end(helper):
    helper.tick(0)
    wait_for(lambda: handles(Path(f"/proc/{helper.process.pid}/status")), what="its handler")
    helper.stop(20)
    assert helper.process.returncode == 7


def test_a_program_that_cannot_be_started_is_tried_again(order, caplog):
    helper = HelperProcess(Starter("/no/such/program"), order, "link_program:main")
    helper.tick(0)
    assert "rtron-link cannot be started" in caplog.text, "it is called as ps shows it"
    helper.stop(20)


def test_one_that_is_needed_seldom_is_looked_after_seldom(order):
    looks = []
    helper = HelperProcess(
        Starter(sys.executable, "-c", CODE), order, "x:main", is_needed=lambda: looks.append(1)
    )
    for tick in range(100):
        helper.tick(tick * BEAT_PERIOD)
    assert len(looks) == 10
    assert helper.process is None
