"""A bulk process that stood still ends; one that works, or waits for a processor, does not."""

import os
import signal
import subprocess
import sys
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.guard.lanes.bulk.stand_still import LONGEST_STAND, StandStillClock
from rtron.vocabulary import SECOND

PROGRAM = """
import sys, time
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.bulk.stand_still import StandStillEnd
loop = EventLoop()
StandStillEnd(loop).open()
loop.call_later(0.2, lambda: print("there", flush=True))
if sys.argv[1] == "works":
    end = time.monotonic() + 2
    def work():
        while time.monotonic() < end: pass
    loop.call_later(0.3, work)
    loop.call_later(2.5, lambda: (print("worked", flush=True), loop.stop()))
loop.run()
loop.close()
print("ended", flush=True)
"""
TIMES = st.integers(0, 10 * SECOND)


@given(TIMES, TIMES, TIMES)
def test_what_is_neither_work_nor_waiting_stands_still(start, busy, idle):
    clock = StandStillClock(start, 7)
    assert clock.update(start + busy + idle, 7 + busy) == idle


@given(TIMES, TIMES)
def test_each_look_counts_from_the_one_before(first, second):
    clock = StandStillClock(0, 0)
    clock.update(first, 0)
    assert clock.update(first + second, 0) == second


def test_work_of_longer_than_the_clock_says_is_no_time_before_zero():
    assert StandStillClock(0, 0).update(10, 11) == 0


@pytest.fixture
def start():
    """Start a process with the loop's part, and end it after the test."""
    started = []

    def run(what):
        command = [sys.executable, "-c", PROGRAM, what]
        started.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        assert started[-1].stdout.readline() == "there\n"
        return started[-1]

    yield run
    for each in started:
        each.kill()
        each.wait()
        each.stdout.close()


def test_a_process_that_stood_still_ends(start):
    process = start("waits")
    os.kill(process.pid, signal.SIGSTOP)
    time.sleep(1.5 * LONGEST_STAND / SECOND)
    os.kill(process.pid, signal.SIGCONT)
    assert process.stdout.readline() == "ended\n"
    assert process.wait(10) == 0


def test_a_process_that_works_for_long_goes_on(start):
    process = start("works")
    assert process.stdout.readline() == "worked\n"
