"""Answers go a few at a time, in order, and none is kept."""

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.service_calls import BURST_SIZE, MAX_PACED, ResponsePacer


@pytest.fixture
def loop():
    loop = EventLoop()
    yield loop
    loop.close()


def send_all(loop, pacer, sent, count):
    """Send numbered answers; return how many went in each step of the loop that sent some."""
    rounds = []
    for number in range(count):
        pacer.send(lambda number=number: sent.append(number))
    rounds.append(len(sent))
    while len(sent) < count:
        before = len(sent)
        loop.step(1)
        rounds += [len(sent) - before] * (len(sent) > before)
    return rounds


def test_a_crowd_of_answers_goes_in_order_a_burst_and_then_one_by_one(loop):
    pacer, sent = ResponsePacer(loop), []
    count = BURST_SIZE + 3
    assert send_all(loop, pacer, sent, count) == [BURST_SIZE, 1, 1, 1]
    assert sent == list(range(count))


def test_after_a_rest_a_burst_goes_at_once_again(loop):
    pacer, sent = ResponsePacer(loop), []
    send_all(loop, pacer, sent, BURST_SIZE + 1)
    while pacer._allowance < BURST_SIZE:
        loop.step(1)
    again = []
    assert send_all(loop, pacer, again, BURST_SIZE + 1) == [BURST_SIZE, 1]


def test_what_waits_is_bounded(loop):
    pacer, sent = ResponsePacer(loop), []
    for number in range(BURST_SIZE + MAX_PACED + 2):
        pacer.send(lambda number=number: sent.append(number))
    assert sent == list(range(BURST_SIZE + 2))
