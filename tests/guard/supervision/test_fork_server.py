"""Programs are started by forks: what they have, how they end, and what if the server is gone."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from harness import lives, wait_for

import rtron

SOURCE = Path(rtron.__file__).parents[1]
PROGRAM = """
import gc, os, select, signal, sys, time
from pathlib import Path
from types import ModuleType
from rtron.guard.supervision.fork_server import ForkServer

def say(numbers):
    os.write(int(numbers), b"here")

def end(numbers):
    sys.exit(int(os.read(int(numbers), 1)))

def shut(numbers):
    os.close(int(numbers))

def fail(numbers):
    raise ValueError("failed")

def wait(numbers):
    os.write(int(numbers), b"w")
    parent = os.getppid()
    while os.getppid() == parent:
        time.sleep(0.05)

program = ModuleType("rtron.guard.supervision.trial_program")
program.say, program.end, program.fail, program.wait = say, end, fail, wait
program.shut = shut
sys.modules[program.__name__] = program
server = ForkServer()
reading, writing = os.pipe()

def start(function, *files):
    return server.start("trial_program:" + function, files)

def started():
    process = start("wait", writing)
    os.read(reading, 1)
    return process

def code(process):
    assert process.wait(20)
    return process.poll()

def attempt():
    try:
        start("say", writing)
    except OSError as error:
        return type(error).__name__

def server_pid():
    return int(Path(f"/proc/self/task/{os.getpid()}/children").read_text())

def status(pid, field):
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return next(line.split()[1] for line in lines if line.startswith(field + ":"))
"""


def run(code):
    """Run code after `PROGRAM`, in a process of its own; return what it prints, read as JSON."""
    ran = subprocess.run(
        [sys.executable, "-c", f"import json\n{PROGRAM}\nprint(json.dumps([{code}]))"],
        env=os.environ | {"PYTHONPATH": str(SOURCE)},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return json.loads(ran.stdout), ran.stderr


def test_a_program_has_its_files_and_ends_well():
    found, errors = run('code(start("say", writing)), os.read(reading, 9).decode()')
    assert found == [0, "here"]
    assert errors == ""


def test_a_program_may_close_its_files():
    found, errors = run('code(start("shut", writing))')
    assert found == [0]
    assert errors == ""


@pytest.mark.parametrize(
    ("how", "code"),
    [
        ('os.write(writing, b"7") and start("end", reading)', 7),
        ('start("fail")', 1),
        ("(p := started()).send_signal(9) or p", -9),
        ("(p := started()).send_signal(15) or p", -15),
    ],
)
def test_the_end_of_a_program_is_told(how, code):
    found, errors = run(f"code({how})")
    assert found == [code]
    assert ("ValueError: failed" in errors) == ("fail" in how)


def test_a_program_that_runs_has_no_end_yet_and_gets_no_signal_after_it():
    found, _ = run(
        "(p := started()).poll(), p.wait(0), p.send_signal(9), p.wait(9), p.send_signal(9)"
    )
    assert found == [None, False, None, True, None]


def test_a_program_is_named_and_hears_no_interrupt_before_it_wants_to():
    bit = 1 << (signal.SIGINT - 1)
    found, _ = run(
        'status(pid := started().pid, "Name"), status(server_pid(), "Name"), status(pid, "SigBlk")'
    )
    assert found[:2] == ["rtron-trial", "rtron-forks"]
    assert int(found[2], 16) & bit


def test_starts_leave_no_file_open():
    count = 'len(os.listdir(f"/proc/{pid}/fd"))'
    counts = f"[{count} for pid in (os.getpid(), server_pid())]"
    found, _ = run(
        f'code(start("say", writing)), {counts}, [code(start("say", writing)) for _ in range(5)], '
        f"{counts}"
    )
    assert found[1] == found[3]


@pytest.mark.parametrize(
    ("number", "error"), [("SIGKILL", "ConnectionResetError"), ("SIGSTOP", "TimeoutError")]
)
def test_a_server_that_is_gone_or_hangs_starts_nothing_and_is_seen_as_gone(number, error):
    seen = "bool(select.select([server.connection], (), (), 20)[0])"
    found, _ = run(f"os.kill(server_pid(), signal.{number}), attempt(), {seen}, attempt()")
    assert found[1] in (error, "BrokenPipeError")
    assert found[2] is True
    assert found[3] in ("BrokenPipeError", "ConnectionResetError")


def test_the_server_ends_with_the_process_that_made_it():
    with subprocess.Popen(
        [sys.executable, "-c", f"{PROGRAM}\nprint(server_pid(), flush=True)\ntime.sleep(600)"],
        env=os.environ | {"PYTHONPATH": str(SOURCE)},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        server = int(process.stdout.readline())
        os.kill(server, signal.SIGTERM)
        assert lives(server)
        process.kill()
    wait_for(lambda: not lives(server), what="the server's end")
