"""What the soak knows of the processes of its app."""

import subprocess
import sys

import pytest

from bench.common import testbed
from bench.soak.app import PROGRAMS, SoakedApp

_WAIT = "open('/proc/self/comm', 'w').write('rtron-{}'); print(flush=True); input()"


@pytest.fixture
def app(tmp_path):
    app = SoakedApp(testbed.Testbed({}, tmp_path), ros=1)
    yield app
    app.close()


@pytest.fixture
def start(tmp_path):
    """Start a process that is called as a program of the guard, and return it when it runs."""
    started = []

    def start(program, folder=tmp_path):
        process = subprocess.Popen(
            [sys.executable, "-c", _WAIT.format(program)],
            env={"ROS_HOME": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        started.append(process)
        process.stdout.readline()
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


def test_a_guard_that_is_there_has_not_ended(app, start):
    for program in PROGRAMS:
        start(program)
    assert app.ended() == []


@pytest.mark.parametrize("gone", PROGRAMS)
def test_a_program_of_the_guard_that_is_gone_is_found(app, start, gone):
    running = {program: start(program) for program in PROGRAMS}
    running[gone].kill()
    running[gone].wait()
    assert app.ended() == [gone]


def test_the_guard_of_another_app_is_not_this_ones(app, start, tmp_path):
    for program in PROGRAMS:
        start(program, tmp_path.parent / "another")
    assert app.ended() == list(PROGRAMS)
