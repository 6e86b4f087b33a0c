"""A connection to a publisher: no socket is left open, and no old command is passed on."""

import socket
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import closing
from dataclasses import replace

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import InputOptions, Peer, TypeInfo
from rtron.guard.transport.ros1.handshake import TopicRequest
from rtron.guard.transport.ros1.subscription import PublisherLink, Subscription
from rtron.wire.ros1.tcpros import LENGTH

PEER = Peer("/talker", TypeInfo("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1"))
REQUEST = TopicRequest("/rtron/a", "/words", "std_msgs/String", "http://localhost:1/")


class HeldWorkers(Executor):
    """Workers that are done when the test says so."""

    def __init__(self):
        self.future = Future()

    def submit(self, *_args, **_kwargs):
        return self.future


@pytest.fixture
def workers():
    return HeldWorkers()


@pytest.fixture
def sock() -> Iterator[socket.socket]:
    ours, theirs = socket.socketpair()
    with closing(ours), closing(theirs):
        yield ours


@pytest.fixture
def loop() -> Iterator[EventLoop]:
    with closing(EventLoop()) as loop:
        yield loop


@pytest.fixture
def link(loop, workers):
    return PublisherLink(loop, workers, REQUEST, "http://localhost:2/", lambda _peer: print)


def test_a_worker_that_connects_after_the_end_leaves_no_socket(link, workers, sock):
    link.close()
    workers.future.set_result((sock, PEER))
    assert sock.fileno() < 0


def test_a_connection_that_the_loop_never_took_is_closed(link, workers, sock):
    workers.future.set_result((sock, PEER))
    assert sock.fileno() >= 0
    link.close()
    assert sock.fileno() < 0


def test_a_connection_that_the_loop_takes_after_the_end_stays_closed(loop, link, workers, sock):
    workers.future.set_result((sock, PEER))
    link.close()
    loop.step(0)
    assert (sock.fileno() < 0, link.is_connected) == (True, False)


def test_the_end_closes_what_the_loop_has_taken(loop, link, workers, sock):
    workers.future.set_result((sock, PEER))
    loop.step(0)
    assert link.is_connected
    link.close()
    assert (sock.fileno() < 0, link.is_connected) == (True, False)


@pytest.mark.parametrize("end", ["fails", "is cancelled"])
def test_a_worker_that_does_not_connect_after_the_end_is_no_error(link, workers, caplog, end):
    link.close()
    if end == "fails":
        workers.future.set_exception(OSError("nobody listens"))
    else:
        workers.future.cancel()
    assert not caplog.records


class LatchedLink:
    """A link to a publisher that latches, and what of its messages is passed on."""

    def __init__(self, loop, *, is_command=True, was_there=True):
        self.heard, self.missed, self._loop = [], [], loop
        options = InputOptions(
            is_command=lambda _peer: is_command,
            on_missed=lambda _peer, count: self.missed.append(count),
        )
        subscription = Subscription("/words", "", lambda uri: self._link(uri, options))
        if not was_there:
            subscription.update([], frozenset())
        self.workers = HeldWorkers()
        subscription.update(["http://localhost:2/"], frozenset())
        self.close = subscription.close

    def _link(self, uri, options):
        receive = self.heard.append
        return PublisherLink(self._loop, self.workers, REQUEST, uri, lambda _peer: receive, options)

    def connect(self, *words):
        """Let the publisher answer, and send words at once; return its end."""
        ours, theirs = socket.socketpair()
        ours.settimeout(0)
        self.workers.future, made = Future(), self.workers.future
        made.set_result((ours, replace(PEER, latching=True)))
        self.say(theirs, *words)
        return theirs

    def say(self, theirs, *words):
        theirs.sendall(b"".join(LENGTH.pack(len(word)) + word for word in words))
        for _ in range(3):
            self._loop.step(0)

    @property
    def words(self):
        return [message[LENGTH.size :] for message in self.heard]


@pytest.mark.parametrize(
    ("kind", "heard"),
    [
        ({}, [b"new"]),
        ({"is_command": False}, [b"old", b"new"]),
        ({"was_there": False}, [b"old", b"new"]),
    ],
)
def test_a_command_that_was_latched_before_we_listened_is_dropped_and_counted(loop, kind, heard):
    with closing(LatchedLink(loop, **kind)) as link, link.connect(b"old", b"new"):
        assert link.words == heard
        assert len(link.missed) == 2 - len(heard)


def test_what_was_latched_while_a_connection_was_gone_is_old(loop, monkeypatch):
    monkeypatch.setattr("rtron.guard.transport.ros1.subscription._FIRST_RETRY_S", 0)
    with closing(LatchedLink(loop, was_there=False)) as link:
        link.connect(b"one").close()
        for _ in range(3):
            loop.step(0)
        with link.connect(b"two", b"three"):
            assert link.words == [b"one", b"three"]


def test_the_first_command_of_one_who_had_latched_nothing_is_passed_on(loop, monkeypatch):
    monkeypatch.setattr("rtron.guard.transport.ros1.subscription._LATCHED_S", 0)
    with closing(LatchedLink(loop)) as link, link.connect() as publisher:
        link.say(publisher, b"first")
        assert link.words == [b"first"]
