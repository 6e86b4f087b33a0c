"""The first change counts at once; of many that follow at most one call comes in each delay."""

import pytest
from app_in_memory import MemoryTransport

from rtron.guard.core.timers import DelayedCall

DELAY = 10


@pytest.fixture
def transport():
    return MemoryTransport()


@pytest.fixture
def calls(transport):
    return Calls(transport)


class Calls:
    """A delayed call that notes when it was made."""

    def __init__(self, transport):
        self.times = []
        self._start = transport.now()
        note = lambda: self.times.append(transport.now() - self._start)  # noqa: E731
        self.schedule = DelayedCall(transport, DELAY, note).schedule


def test_the_first_comes_after_the_event_in_which_it_was_asked_for(transport, calls):
    calls.schedule()
    calls.schedule()
    assert calls.times == []
    transport.advance(0)
    assert calls.times == [0]


def test_what_follows_soon_waits_and_comes_once(transport, calls):
    calls.schedule()
    transport.advance(1)
    for _ in range(5):
        calls.schedule()
    transport.advance(DELAY - 2)
    assert calls.times == [0]
    transport.advance(1)
    assert calls.times == [0, DELAY]


def test_what_follows_late_comes_at_once(transport, calls):
    calls.schedule()
    transport.advance(3 * DELAY)
    calls.schedule()
    transport.advance(0)
    assert calls.times == [0, 3 * DELAY]
