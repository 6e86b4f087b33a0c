"""The process beside the guard is started again, more seldom if it ends at once."""

import os
import signal
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from harness import wait_for

from rtron.guard.supervision import link_process as module
from rtron.guard.supervision.link_process import MAX_RESTART_DELAY, MIN_RESTART_DELAY, LinkProcess
from rtron.vocabulary import SECOND


@pytest.fixture
def order():
    reading, writing = os.pipe()
    yield reading
    os.close(reading)
    os.close(writing)


@pytest.fixture
def companion(order, monkeypatch):
    code = "import signal; signal.signal(signal.SIGTERM, lambda *_: exit(7)); signal.pause()"
    monkeypatch.setattr(module, "command", lambda role, files: [sys.executable, "-c", code])
    companion = LinkProcess(order)
    yield companion
    companion.stop()


def end(companion):
    companion.process.kill()
    companion.process.wait()


def handles(status):
    caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) & (1 << (signal.SIGTERM - 1))


def test_it_runs_once(companion):
    companion.tick(0)
    first = companion.process
    companion.tick(MAX_RESTART_DELAY)
    assert companion.process is first


def test_it_is_started_again_but_not_at_once(companion):
    companion.tick(0)
    first = companion.process
    end(companion)
    companion.tick(5)
    companion.tick(5 + MIN_RESTART_DELAY - 1)
    assert companion.process is first
    companion.tick(5 + MIN_RESTART_DELAY)
    assert companion.process is not first


def test_one_that_keeps_ending_is_tried_more_seldom(companion):
    starts, last = [], None
    for second in range(300):
        companion.tick(second * SECOND)
        if companion.process is not last:
            last = companion.process
            starts.append(second)
            end(companion)
    gaps = [after - before - 1 for before, after in pairwise(starts)]
    assert gaps[:6] == [1, 2, 4, 8, 16, MAX_RESTART_DELAY // SECOND]
    assert set(gaps[6:]) == {MAX_RESTART_DELAY // SECOND}


def test_one_that_ran_for_long_is_started_again_soon(companion):
    now = 0
    for _ in range(4):
        companion.tick(now)
        end(companion)
        companion.tick(now := now + 1)
        now += MAX_RESTART_DELAY
    companion.tick(now)
    lasting = companion.process
    companion.tick(now := now + MAX_RESTART_DELAY)
    end(companion)
    companion.tick(now)
    companion.tick(now + MIN_RESTART_DELAY)
    assert companion.process is not lasting


def test_it_is_told_to_end(companion):
    companion.tick(0)
    wait_for(lambda: handles(Path(f"/proc/{companion.process.pid}/status")), what="its handler")
    companion.stop()
    assert companion.process.returncode == 7


def test_a_program_that_cannot_be_started_is_tried_again(order, monkeypatch, caplog):
    monkeypatch.setattr(module, "command", lambda role, files: ["/no/such/program"])
    companion = LinkProcess(order)
    companion.tick(0)
    assert "cannot be started" in caplog.text
    companion.stop()
