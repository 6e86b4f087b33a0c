"""Two ends of a Unix socket between processes of the guard; neither waits for the other."""

import logging
import socket
import struct

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.exchange.message_channel import (
    MAX_MESSAGE_BYTES,
    MAX_PENDING_BYTES,
    MessageChannel,
)


class ChannelEnd:
    """One end, and what it has heard."""

    def __init__(self, loop, sock):
        self.heard, self.losses = [], 0
        self.channel = MessageChannel(loop, sock, self.heard.append, self._count_loss)

    def _count_loss(self):
        self.losses += 1


@pytest.fixture
def loop():
    made = EventLoop()
    yield made
    made.close()


@pytest.fixture
def sockets():
    pair = socket.socketpair()
    yield pair
    for each in pair:
        each.close()


def run_until(loop, condition):
    deadline = loop.now() + 20 * 10**9
    while not condition():
        assert loop.now() < deadline
        loop.step(0.05)


def test_messages_arrive_whole_and_in_order(loop, sockets):
    one, other = (ChannelEnd(loop, each) for each in sockets)
    told = [{"number": n, "body": b"x" * (n * 50)} for n in range(400)]
    for message in told[:100]:
        one.channel.send(message)
    run_until(loop, lambda: len(other.heard) == 100)
    for message in told[100:]:
        one.channel.send(message)
        loop.step(0)
    run_until(loop, lambda: len(other.heard) == 400)
    assert other.heard == told
    other.channel.send("back")
    run_until(loop, lambda: one.heard == ["back"])


def test_an_end_that_goes_is_noticed_once(loop, sockets):
    one, other = (ChannelEnd(loop, each) for each in sockets)
    one.channel.close()
    run_until(loop, lambda: other.losses)
    one.channel.send("nothing happens")
    other.channel.send("nothing happens")
    assert (one.losses, other.losses) == (1, 1)


def test_who_does_not_read_is_given_up(loop, sockets):
    one = ChannelEnd(loop, sockets[0])
    for _ in range(MAX_PENDING_BYTES // (1 << 16)):
        one.channel.send(b"x" * (1 << 16))
        if one.losses:
            break
    one.channel.send(b"x" * (1 << 20))
    assert one.losses == 1


def test_a_message_that_is_too_long_is_refused_and_the_connection_stays(loop, sockets, caplog):
    one, other = (ChannelEnd(loop, each) for each in sockets)
    with caplog.at_level(logging.ERROR):
        for _ in range(5):
            one.channel.send(b"x" * MAX_MESSAGE_BYTES)
    one.channel.send("an alarm")
    run_until(loop, lambda: other.heard)
    assert other.heard == ["an alarm"]
    assert (one.losses, other.losses) == (0, 0)
    assert [each.levelname for each in caplog.records] == ["ERROR"]
    assert "bytes" in caplog.text


def test_a_message_of_the_longest_length_arrives(loop, sockets):
    one, other = (ChannelEnd(loop, each) for each in sockets)
    one.channel.send(b"x" * (MAX_MESSAGE_BYTES - 100))
    run_until(loop, lambda: other.heard)
    assert one.losses == 0


def test_who_announces_too_much_is_given_up(loop, sockets):
    other = ChannelEnd(loop, sockets[1])
    sockets[0].sendall(struct.pack("=I", MAX_MESSAGE_BYTES + 1))
    run_until(loop, lambda: other.losses)
    assert other.heard == []
