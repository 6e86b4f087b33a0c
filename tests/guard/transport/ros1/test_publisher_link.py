"""A connection to a publisher that ends while a worker makes it: no socket is left open."""

import socket
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from contextlib import closing

import pytest

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.protocol import Peer, TypeInfo, ignore_lost
from rtron.guard.transport.ros1.handshake import TopicRequest
from rtron.guard.transport.ros1.subscription import PublisherLink

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
    return PublisherLink(
        loop, workers, REQUEST, "http://localhost:2/", lambda _peer: print, ignore_lost
    )


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
