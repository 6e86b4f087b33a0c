"""Messages to one subscriber: the first of an event goes at once, an error harms nobody else."""

import socket
import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from functools import partial

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import OutputOptions, TypeInfo
from rtron.guard.transport.ros1.publication import Publication
from rtron.guard.transport.ros1.subscriber_link import MAX_NAME, SubscriberLink
from rtron.wire.ros1.tcpros import decode_header, encode_header

MESSAGES = [b"%03d" % number for number in range(200)]
ALL = b"".join(MESSAGES)
LIMIT_S = 60


class Connection:
    """A link and its subscriber's end."""

    def __init__(self, loop: EventLoop) -> None:
        with socket.create_server(("127.0.0.1", 0)) as server:
            self.subscriber = socket.create_connection(server.getsockname(), LIMIT_S)
            ours, _ = server.accept()
        ours.settimeout(0)
        self.link = SubscriberLink(loop, ours, lambda link, fields: None)
        self.link.md5sum = "*"
        self.link.set_queue_size(len(MESSAGES))

    def receive(self, size: int) -> bytes:
        return self.subscriber.recv(size, socket.MSG_WAITALL)

    def reset(self) -> None:
        self.subscriber.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.subscriber.close()


@pytest.fixture
def loop() -> Iterator[EventLoop]:
    with closing(EventLoop()) as loop:
        yield loop


@pytest.fixture
def connections(loop: EventLoop) -> Iterator[tuple[Connection, Connection]]:
    connections = Connection(loop), Connection(loop)
    yield connections
    for each in connections:
        each.link.close()
        each.subscriber.close()


@pytest.fixture
def connection(connections: tuple[Connection, Connection]) -> Connection:
    return connections[0]


def during_an_event(loop: EventLoop, act: Callable[[], None]) -> None:
    loop.call_at(loop.now(), act)
    loop.step(0)


def send_all(link: SubscriberLink) -> None:
    for each in MESSAGES:
        link.send(each)


def test_the_first_message_of_an_event_is_there_before_the_event_ends(
    loop: EventLoop, connection: Connection
) -> None:
    seen: list[bytes] = []

    def act() -> None:
        connection.link.send(MESSAGES[0])
        seen.append(connection.receive(len(MESSAGES[0])))

    during_an_event(loop, act)
    assert seen == [MESSAGES[0]]


def test_all_messages_of_an_event_arrive_once_and_in_their_order(
    loop: EventLoop, connection: Connection
) -> None:
    during_an_event(loop, partial(send_all, connection.link))
    assert connection.receive(len(ALL)) == ALL
    assert connection.link.sent == len(MESSAGES)


def test_messages_behind_one_that_does_not_fit_keep_their_order(
    loop: EventLoop, connection: Connection
) -> None:
    large = bytes(1 << 22)
    during_an_event(loop, partial(connection.link.send, large))
    during_an_event(loop, partial(send_all, connection.link))
    rest = len(large) + len(ALL)
    arrived = b""
    while rest := rest - len(arrived):
        arrived = connection.subscriber.recv(rest)
        loop.step(0)
    assert arrived.endswith(ALL[-len(arrived) :])


def test_a_subscriber_that_has_gone_keeps_no_message_from_the_next(
    loop: EventLoop, connections: tuple[Connection, Connection]
) -> None:
    gone, there = connections
    publication = Publication("/guard", "/topic", "", loop.now, OutputOptions(queue_size=1))
    publication.learn_type(TypeInfo("std_msgs/Empty", "*"))
    for each in connections:
        publication.add_subscriber(each.link, {})
        assert each.subscriber.recv(1 << 16), "the header"
    gone.reset()
    publication.publish(MESSAGES[0])
    assert there.receive(len(MESSAGES[0])) == MESSAGES[0]
    loop.step(0)
    assert publication.links == [there.link]


def subscribe(loop: EventLoop, name: str, **fields: str) -> tuple[SubscriberLink, dict[str, str]]:
    """Return the link of a subscriber with a name, and the answer to it."""
    options = OutputOptions(queue_size=1, successors=("/driver",))
    publication = Publication("/guard", "/out", "a/B", loop.now, options)
    with socket.create_server(("127.0.0.1", 0)) as server:
        theirs = socket.create_connection(server.getsockname(), LIMIT_S)
        ours, _ = server.accept()
    ours.settimeout(0)
    link = SubscriberLink(loop, ours, publication.add_subscriber)
    header = encode_header({"callerid": name, "type": "a/B", "md5sum": "x"} | fields)
    theirs.settimeout(LIMIT_S)
    with theirs:
        sent = 0
        while sent < len(header):
            sent += theirs.send(header[sent : sent + (1 << 14)])
            loop.step(0.01)
        (size,) = struct.unpack("<I", theirs.recv(4, socket.MSG_WAITALL))
        return link, decode_header(theirs.recv(size, socket.MSG_WAITALL))


@pytest.mark.parametrize("length", [MAX_NAME + 1, 1 << 19])
def test_a_name_that_is_too_long_is_refused(
    loop: EventLoop, caplog: pytest.LogCaptureFixture, length: int
) -> None:
    link, answer = subscribe(loop, "/" + "x" * (length - 1))
    assert link.is_closed
    assert answer == {"error": f"its name has {length} bytes, the limit is {MAX_NAME}"}
    assert len(caplog.text) < 1000


def test_a_long_name_is_accepted(loop: EventLoop) -> None:
    link, answer = subscribe(loop, "/" + "x" * (MAX_NAME - 1))
    assert not link.is_closed
    assert answer["callerid"] == "/guard"
    link.close()


def test_a_long_type_fills_no_log(loop: EventLoop, caplog: pytest.LogCaptureFixture) -> None:
    link, answer = subscribe(loop, "/x", type="y" * (1 << 19))
    assert link.is_closed
    assert answer["error"].startswith("/out is of type a/B, not yyy")
    assert len(caplog.text) < 2000
