"""Answers go a few at a time, in order, and again to who does not know the service yet."""

import math

import pytest

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.responses import (
    BURST_SIZE,
    MAX_PACED,
    MAX_UNSENT,
    ResponsePacer,
    ResponseRetry,
)


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


ONE, OTHER = b"client 1", b"client 2"


class Client:
    """Knows the service at an attempt to respond to it, or never."""

    def __init__(self, known_at=math.inf):
        self.attempts, self._known_at = 0, known_at

    def respond(self):
        self.attempts += 1
        return self.attempts >= self._known_at


@pytest.fixture
def retry(loop, monkeypatch):
    monkeypatch.setattr("rtron.guard.transport.ros2.responses._RETRY_PERIOD", 0)
    return ResponseRetry(loop, "/lamp")


def test_who_does_not_know_the_service_yet_is_answered_later(loop, retry, caplog):
    client = Client(known_at=3)
    for _ in range(2):
        retry.send(ONE, client.respond)
    assert client.attempts == 1
    loop.step(0)
    assert client.attempts == 2
    loop.step(0)
    loop.step(0)
    assert (client.attempts, retry.lost, caplog.text) == (4, 0, "")


def test_one_attempt_a_turn_fails_however_many_wait(loop, retry):
    unknown, known = Client(), Client(known_at=1)
    for number in range(10):
        retry.send(b"client %d" % number, unknown.respond)
    retry.send(OTHER, known.respond)
    assert (unknown.attempts, known.attempts) == (10, 0)
    loop.step(0)
    assert unknown.attempts == 11


def test_what_is_lost_is_told_and_counted(loop, retry, caplog, monkeypatch):
    monkeypatch.setattr("rtron.guard.transport.ros2.responses._RETRY_TIMEOUT", 0)
    for _ in range(MAX_UNSENT + 1):
        retry.send(ONE, Client().respond)
    assert retry.lost == 1
    loop.step(0)
    assert retry.lost == MAX_UNSENT + 1
    assert f"/lamp: an answer is lost: {MAX_UNSENT} wait already; 1 so far" in caplog.text


def test_a_response_that_cannot_be_sent_is_lost_at_once(retry, caplog):
    def fail():
        raise WireError("rcl cannot respond")

    retry.send(ONE, fail)
    assert "/lamp: an answer is lost: rcl cannot respond; 1 so far" in caplog.text
