"""What a process in a cell may send: frames are bounded, and messages are checked."""

import json
import socket
import struct
from contextlib import closing

import pytest

pytest.importorskip("pydantic")
from rtron.guard.cell.ros2.carrier_channel import MAX_MESSAGE_BYTES, CarrierChannel
from rtron.guard.cell.ros2.messages import FROM_CARRIER, TO_CARRIER, Beat, Introduce, decode, encode
from rtron.guard.core.event_loop import EventLoop

READ_AT_ONCE = 1 << 16
HEAD = struct.Struct("=IIIq")


class Channel:
    """A channel of which the test has the other end."""

    def __init__(self, adapter=FROM_CARRIER):
        self.loop = EventLoop()
        self.other, ours = socket.socketpair()
        self.messages, self.data, self.lost = [], [], []
        self.channel = CarrierChannel(
            self.loop,
            ours,
            adapter,
            self.messages.append,
            self.data.append,
            lambda: self.lost.append(True),
        )

    def receive(self, *frames):
        """Send frames, and let the channel read until there is no more."""
        self.other.sendall(b"".join(frames))
        for _ in range(1 + sum(map(len, frames)) // READ_AT_ONCE):
            self.loop.step(0)

    def close(self):
        self.channel.close()
        self.other.close()
        self.loop.close()


@pytest.fixture
def channel():
    with closing(Channel()) as channel:
        yield channel


def frame(body, id=0, tag=0, size=None):
    return HEAD.pack(len(body) if size is None else size, id, tag, 7) + body


def test_messages_and_data_come_in_order_however_they_are_cut(channel):
    whole = frame(encode(Beat())) + frame(b"abc", id=3, tag=2) + frame(encode(Beat()))
    for at in range(len(whole)):
        channel.receive(whole[at : at + 1])
    assert channel.messages == [Beat(), Beat()]
    (data,) = channel.data
    assert (data.id, data.tag, data.sent_at, data.message) == (3, 2, 7, b"abc")
    assert not channel.lost


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"\x80\x04N.",
        b"null",
        b"[]",
        b'{"kind": "pickle"}',
        b'{"kind": "introduce", "role": "guard"}',
        b'{"kind": "lost", "connection": "1"}',
        b'{"kind": "lost"}',
        b'{"kind": "subscribers", "id": 1, "nodes": [1]}',
        b"[" * 100_000,
        json.dumps({"kind": "found", "subscription": 1, "connection": 1, "peer": {}}).encode(),
    ],
)
def test_what_is_no_message_of_a_carrier_ends_the_connection(channel, body):
    channel.receive(frame(encode(Beat())), frame(body), frame(encode(Beat())))
    assert channel.messages == [Beat()]
    assert channel.lost == [True]


@pytest.mark.parametrize(("id", "size"), [(0, (1 << 22) + 1), (1, MAX_MESSAGE_BYTES + 1)])
def test_a_frame_that_is_too_long_ends_the_connection_before_it_comes(channel, id, size):
    channel.receive(frame(b"", id=id, size=size))
    assert channel.lost == [True]


def test_only_one_side_may_request(channel):
    introduction = encode(Introduce("guard"))
    assert decode(TO_CARRIER, introduction) == Introduce("guard")
    channel.receive(frame(introduction))
    assert channel.lost == [True]


def test_the_end_of_the_other_side_is_told_once(channel):
    channel.other.close()
    channel.loop.step(1)
    channel.channel.close()
    assert channel.lost == [True]


def test_who_does_not_read_loses_data_and_then_the_connection(channel):
    large = bytes(MAX_MESSAGE_BYTES)
    assert channel.channel.send_data(1, large)
    assert channel.channel.send_data(1, large)
    assert not channel.channel.send_data(1, b"one more")
    assert not channel.channel.send_data(1, large + b"1")
    for _ in range(20):
        channel.channel.send(Introduce("x" * (1 << 22)))
    assert channel.lost == [True]
