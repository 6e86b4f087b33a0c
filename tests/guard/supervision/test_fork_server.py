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
from rtron.guard.supervision.fork_server import START_FAILED, UNKNOWN_END
from rtron.guard.supervision.programs import TERMINAL_SIGNALS

SOURCE = Path(rtron.__file__).parents[1]
AT_ONCE_S = 0.5
PROGRAM = """
import gc, os, select, signal, sys, time
from pathlib import Path
from types import ModuleType
import resource
from rtron.guard.supervision import fork_server
from rtron.guard.supervision.fork_server import ForkServer
from rtron.vocabulary import SECOND

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

def finish(numbers):
    begun, ended = map(int, numbers.split(","))
    signal.signal(signal.SIGTERM, lambda *_: os._exit(os.write(ended, b"bye") - 3))
    os.write(begun, b"w")
    while True:
        signal.pause()

program = ModuleType("rtron.guard.supervision.trial_program")
program.say, program.end, program.fail, program.wait = say, end, fail, wait
program.shut, program.finish = shut, finish
sys.modules[program.__name__] = program
server = ForkServer()
reading, writing = os.pipe()

def start(function, *files):
    return server.start("trial_program:" + function, files)

def hears(seconds=20):
    return bool(select.select([server.connection], (), (), seconds)[0]) and server.receive()

def started(function="wait", *files):
    process = start(function, *(files or [writing]))
    while not process.pid and hears():
        pass
    return process

def waiting():
    process = started()
    os.read(reading, 1)
    return process

def code(process):
    while process.poll() is None and hears():
        pass
    return process.poll()

def attempt():
    try:
        return start("say", writing).poll()
    except OSError as error:
        return type(error).__name__

def took(call):
    began = time.monotonic()
    call()
    return time.monotonic() - began

def killed_as_hung():
    for n in range(4000):
        server.end_if_hung(time.monotonic_ns() + n * SECOND // 100)
    while hears():
        pass
    return True

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
        ("(p := waiting()).send_signal(9) or p", -9),
        ("(p := waiting()).send_signal(15) or p", -15),
    ],
)
def test_the_end_of_a_program_is_told(how, code):
    found, errors = run(f"code({how})")
    assert found == [code]
    assert ("ValueError: failed" in errors) == ("fail" in how)


def test_a_program_that_runs_has_no_end_yet_and_gets_no_signal_after_it():
    found, _ = run(
        "(p := waiting()).poll(), p.wait(0), p.send_signal(9), p.wait(9), p.send_signal(9), code(p)"
    )
    assert found == [None, False, None, True, None, -9]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_signal_before_the_start_is_not_lost(number):
    found, _ = run(f'(p := start("wait", writing)).send_signal({number:d}), p.pid, code(p)')
    assert found == [None, 0, -number]


def test_a_program_that_cannot_be_started_has_an_end_too():
    """The fork server has no file descriptor left to see its end by."""
    highest = 'max(map(int, os.listdir(f"/proc/{server_pid()}/fd")))'
    cannot = f"resource.prlimit(server_pid(), resource.RLIMIT_NOFILE, ({highest} + 1,) * 2)"
    found, errors = run(f"{cannot}, [p := start('say', writing), code(p)][1]")
    assert found[1] == START_FAILED
    assert "a process of the guard cannot be started: Too many open files" in errors


def test_a_program_is_named_and_hears_no_terminal_before_it_wants_to():
    bits = sum(1 << (number - 1) for number in TERMINAL_SIGNALS)
    found, _ = run(
        'status(pid := waiting().pid, "Name"), status(server_pid(), "Name"), status(pid, "SigBlk")'
    )
    assert found[:2] == ["rtron-trial", "rtron-forks"]
    assert int(found[2], 16) & bits == bits


def test_starts_leave_no_file_open():
    count = 'len(os.listdir(f"/proc/{pid}/fd"))'
    counts = f"[{count} for pid in (os.getpid(), server_pid())]"
    found, _ = run(
        f'code(start("say", writing)), {counts}, [code(start("say", writing)) for _ in range(5)], '
        f"{counts}"
    )
    assert found[1] == found[3]


def test_a_server_that_is_gone_starts_nothing_and_tells_of_no_end():
    found, _ = run(
        "(p := waiting()).poll(), os.kill(server_pid(), 9), p.wait(20), code(p), attempt(), hears()"
    )
    assert found == [None, None, True, UNKNOWN_END, "BrokenPipeError", False]


def test_nobody_waits_for_a_server_that_hangs_and_it_is_killed():
    found, _ = run(
        "(p := waiting()).poll(), os.kill(server_pid(), signal.SIGSTOP), "
        "took(lambda: start('say', writing)), p.send_signal(9), p.wait(20), "
        "took(p.poll), p.poll(), killed_as_hung(), code(p)"
    )
    assert found[2] < AT_ONCE_S > found[5]
    assert found[3:5] + found[6:] == [None, True, None, True, UNKNOWN_END]


def test_a_server_that_waits_beats_and_is_left_alone():
    found, _ = run(
        "[server.end_if_hung(n * SECOND) for n in range(9) if hears(0.3)], hears(0.3), "
        "code(start('say', writing))"
    )
    assert found[1:] == [False, 0]


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


def ended_supervisor(code):
    """Run code in a supervisor, kill that, and return what the code has printed."""
    code = f"{PROGRAM}\nfork_server._END_S = 0.3\n{code}\ntime.sleep(600)"
    environment = os.environ | {"PYTHONPATH": str(SOURCE)}
    command = [sys.executable, "-c", code]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as process:
        pids = [int(word) for word in process.stdout.readline().split()]
        process.kill()
        return pids, process.stdout.read()


def test_a_program_that_is_frozen_does_not_stay_behind():
    (pid,), _ = ended_supervisor(
        "p = waiting()\nos.kill(p.pid, signal.SIGSTOP)\nprint(p.pid, flush=True)"
    )
    wait_for(lambda: not lives(pid), what="the end of the program")


@pytest.mark.parametrize(
    "unread", ["", "\nstart('say', writing)\nselect.select([server.connection], (), ())"]
)
def test_a_program_ends_in_order_after_the_supervisor(unread):
    (pid,), said = ended_supervisor(
        f"p = started('finish', writing, 1)\nos.read(reading, 1){unread}\nprint(p.pid, flush=True)"
    )
    assert said.endswith("bye")
    wait_for(lambda: not lives(pid), what="the end of the program")


def test_a_program_ends_at_once_with_the_fork_server():
    found, _ = run(
        "(p := started('finish', writing, 1)).pid, os.kill(server_pid(), 9), p.wait(20), code(p)"
    )
    assert found[1:] == [None, True, UNKNOWN_END]
