"""What the executors' tests run in other processes; those import it by name."""

import os
import signal


def square(number):
    return number * number


def fail_at_three(number):
    if number == 3:
        raise ValueError("three")
    return number


def end_at_three(number):
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def recurse_at_three(number):
    return recurse_at_three(number) if number == 3 else number


def process(_):
    return os.getpid()
