"""One thread watches the time limits of all tests of a process.

pytest-timeout starts and ends a thread for each test, which takes 0.4 ms of processor time.
"""

from threading import Event, Thread
from time import monotonic

import pytest
from pytest_timeout import timeout_timer

_LOOK_S = 0.5
_running = {}
"""The test that runs: when its time is over, and its settings."""


@pytest.hookimpl(optionalhook=True)
def pytest_timeout_set_timer(item, settings):
    """Let the thread know a test's limit, in place of the plugin."""
    _running[item] = monotonic() + settings.timeout, settings
    return True


@pytest.hookimpl(optionalhook=True)
def pytest_timeout_cancel_timer(item):
    """Forget a test's limit, in place of the plugin."""
    _running.pop(item, None)
    return True


def pytest_sessionstart():
    """Begin to watch."""
    Thread(target=_watch, args=(monotonic, Event()), name="time limits", daemon=True).start()


def _watch(clock, pause):
    """End the process at a test that runs for too long, as the plugin does, and show its stacks."""
    while not pause.wait(_LOOK_S):
        for item, (end, settings) in tuple(_running.items()):
            if clock() > end:
                timeout_timer(item, settings)
