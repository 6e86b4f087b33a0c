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
    helper.stop()


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


def test_it_is_told_to_end(helper):
    helper.tick(0)
    wait_for(lambda: handles(Path(f"/proc/{helper.process.pid}/status")), what="its handler")
    helper.stop()
    assert helper.process.returncode == 7


def test_a_program_that_cannot_be_started_is_tried_again(order, caplog):
    helper = HelperProcess(Starter("/no/such/program"), order, "link_program:main")
    helper.tick(0)
    assert "cannot be started" in caplog.text
    helper.stop()
