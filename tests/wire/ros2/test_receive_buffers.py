"""Room for a crowd of messages in the sockets that are opened meanwhile, and in no others."""

import socket
from contextlib import ExitStack

import pytest

from rtron.wire.ros2.discovery_tuning import RECEIVE_BUFFER_BYTES, large_receive_buffers


def room(sock):
    return sock.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)


@pytest.fixture
def opened():
    with ExitStack() as stack:
        yield lambda kind: stack.enter_context(socket.socket(socket.AF_INET, kind))


def test_datagram_sockets_of_the_block_get_room(opened):
    with large_receive_buffers():
        sock = opened(socket.SOCK_DGRAM)
        before = room(sock)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as most:
        most.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
        assert room(sock) == room(most) >= before


def test_they_still_work_afterwards(opened):
    with large_receive_buffers():
        sock = opened(socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    sock.settimeout(60)
    sock.sendto(b"word", sock.getsockname())
    assert sock.recv(10) == b"word"


def test_others_keep_what_they_have(opened):
    earlier = opened(socket.SOCK_DGRAM)
    before = room(earlier)
    with large_receive_buffers():
        stream = opened(socket.SOCK_STREAM)
        its = room(stream)
    later = opened(socket.SOCK_DGRAM)
    assert (room(earlier), room(stream), room(later)) == (before, its, before)


def test_a_socket_that_is_closed_meanwhile_is_no_fault(opened):
    with large_receive_buffers():
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM):
            stays = opened(socket.SOCK_DGRAM)
        before = room(stays)
    assert room(stays) > before
