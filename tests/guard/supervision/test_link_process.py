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
def link_process(order, monkeypatch):
    code = "import signal; signal.signal(signal.SIGTERM, lambda *_: exit(7)); signal.pause()"
    monkeypatch.setattr(module, "command", lambda role, files: [sys.executable, "-c", code])
    link_process = LinkProcess(order)
    yield link_process
    link_process.stop()


def end(link_process):
    link_process.process.kill()
    link_process.process.wait()


def handles(status):
    caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt"))
    return int(caught.split()[1], 16) & (1 << (signal.SIGTERM - 1))


def test_it_runs_once(link_process):
    link_process.tick(0)
    first = link_process.process
    link_process.tick(MAX_RESTART_DELAY)
    assert link_process.process is first


def test_it_is_started_again_but_not_at_once(link_process):
    link_process.tick(0)
    first = link_process.process
    end(link_process)
    link_process.tick(5)
    link_process.tick(5 + MIN_RESTART_DELAY - 1)
    assert link_process.process is first
    link_process.tick(5 + MIN_RESTART_DELAY)
    assert link_process.process is not first


def test_one_that_keeps_ending_is_tried_more_seldom(link_process):
    starts, last = [], None
    for second in range(300):
        link_process.tick(second * SECOND)
        if link_process.process is not last:
            last = link_process.process
            starts.append(second)
            end(link_process)
    gaps = [after - before - 1 for before, after in pairwise(starts)]
    assert gaps[:6] == [1, 2, 4, 8, 16, MAX_RESTART_DELAY // SECOND]
    assert set(gaps[6:]) == {MAX_RESTART_DELAY // SECOND}


def test_one_that_ran_for_long_is_started_again_soon(link_process):
    now = 0
    for _ in range(4):
        link_process.tick(now)
        end(link_process)
        link_process.tick(now := now + 1)
        now += MAX_RESTART_DELAY
    link_process.tick(now)
    lasting = link_process.process
    link_process.tick(now := now + MAX_RESTART_DELAY)
    end(link_process)
    link_process.tick(now)
    link_process.tick(now + MIN_RESTART_DELAY)
    assert link_process.process is not lasting


def test_it_is_told_to_end(link_process):
    link_process.tick(0)
    wait_for(lambda: handles(Path(f"/proc/{link_process.process.pid}/status")), what="its handler")
    link_process.stop()
    assert link_process.process.returncode == 7


def test_a_program_that_cannot_be_started_is_tried_again(order, monkeypatch, caplog):
    monkeypatch.setattr(module, "command", lambda role, files: ["/no/such/program"])
    link_process = LinkProcess(order)
    link_process.tick(0)
    assert "cannot be started" in caplog.text
    link_process.stop()
