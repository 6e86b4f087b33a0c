"""What strangers can cause is sent at a limited rate."""

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.node_reports import (
    MAX_PER_PERIOD,
    MAX_WAITING,
    PERIOD,
    RateLimitedSender,
)

COME, GONE = ("subscribed", "/out", "/driver"), ("unsubscribed", "/out", "/driver")


class Clock:
    """A loop whose time the test sets."""

    def __init__(self):
        self.time, self.timers = 0, []

    def now(self):
        return self.time

    def call_at(self, when, callback):
        self.timers.append((when, callback))

    def pass_period(self):
        self.time += PERIOD
        due = [callback for when, callback in self.timers if when <= self.time]
        self.timers = [each for each in self.timers if each[0] > self.time]
        for callback in due:
            callback()


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def sent():
    return []


@pytest.fixture
def sender(clock, sent):
    return RateLimitedSender(sent.append, clock)


def test_a_message_is_sent_at_once(sender, sent):
    for each in (COME, GONE):
        sender.send(each)
    assert sent == [COME, GONE]


def test_a_node_that_comes_and_goes_is_told_once_a_period(sender, sent, clock):
    for _ in range(5000):
        sender.send(COME)
        sender.send(GONE)
    assert sent == [COME, GONE]
    clock.pass_period()
    assert sent == [COME, GONE, COME, GONE]
    for _ in range(5):
        clock.pass_period()
    assert len(sent) == 4
    assert clock.timers == []
    sender.send(COME)
    assert sent[4:] == [COME]


def test_many_nodes_are_told_in_turn_and_none_is_lost(sender, sent, clock):
    nodes = [("subscribed", "/out", f"/wheel_{number}") for number in range(3 * MAX_PER_PERIOD)]
    for each in nodes:
        sender.send(each)
    assert len(sent) == MAX_PER_PERIOD
    for _ in range(4):
        clock.pass_period()
    assert sent == nodes


def test_what_waits_is_bounded(sender, sent, clock, caplog):
    for number in range(10 * MAX_WAITING):
        sender.send(("subscribed", "/out", f"/wheel_{number}"))
    for _ in range(2 * MAX_WAITING // MAX_PER_PERIOD):
        clock.pass_period()
    assert len(sent) == MAX_WAITING + MAX_PER_PERIOD
    assert len(caplog.records) == 1


def test_a_real_loop_sends_what_waits():
    sent, loop = [], EventLoop()
    sender = RateLimitedSender(sent.append, loop)
    for _ in range(2):
        sender.send(COME)
    end = loop.now() + 10 * 10**9
    while len(sent) < 2:
        assert loop.now() < end
        loop.step(0.01)
    loop.close()
