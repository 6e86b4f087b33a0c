"""A camera that falls from 30 frames a second to 2, and rises again: for nodes of both ROS."""

import signal
import sys
import time

RATE = 30
_LEFT_OUT = 15


def say(text):
    """Write a line in one call: two threads write."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


def say_speed(twist):
    """Say what the base is told, and when."""
    say(f"speed {twist.linear.x} {time.monotonic()}")


class Film:
    """Takes a frame at every tick, and at every 15th from a SIGUSR1 to the next one.

    It says `slow` and `fast` when that begins, and `frame` when it has taken one.
    """

    def __init__(self, take):
        self._take = take
        self._signals = self._noticed = self._ticks = 0
        signal.signal(signal.SIGUSR1, self._hear)

    def _hear(self, *_):
        self._signals += 1

    def tick(self, *_):
        if self._noticed < self._signals:
            self._noticed, self._ticks = self._signals, 0
            say("slow" if self._noticed % 2 else "fast")
        self._ticks += 1
        if self._noticed % 2 == 0 or self._ticks % _LEFT_OUT == 0:
            self._take()
            say("frame")
