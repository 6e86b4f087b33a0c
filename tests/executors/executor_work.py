"""What the executors' tests run in other processes; those import it by name."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

LIMIT = 60.0


def square(number):
    return number * number


def fail_at_three(number):
    if number == 3:
        raise ValueError("three")
    return number


def kill_at_three(number):
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def recurse_at_three(number):
    return recurse_at_three(number) if number == 3 else number


def process_id(_):
    return os.getpid()


def wait_for_other(folder):
    """Return this process's id as soon as another one has come to the folder, else None."""
    (Path(folder) / str(os.getpid())).touch()
    until = time.monotonic() + LIMIT
    while time.monotonic() < until:
        if sum(1 for _ in Path(folder).iterdir()) > 1:
            return os.getpid()
        time.sleep(0.01)
    return None


def sleep_marked(folder):
    """Put this process's id into a folder, and stay."""
    (Path(folder) / str(os.getpid())).touch()
    time.sleep(LIMIT)


def start_child_sleep(folder):
    """Put the id of a process that this one has started into a folder, and wait for it."""
    command = [sys.executable, "-c", f"import time; time.sleep({LIMIT})"]
    with subprocess.Popen(command) as started:
        (Path(folder) / str(started.pid)).touch()
