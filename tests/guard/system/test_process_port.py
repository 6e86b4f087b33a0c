"""Where two processes meet: what connects waits for who accepts, within a bound."""

import os

import pytest

from rtron.guard.system.process_port import ProcessPort, accept, connect


@pytest.fixture
def port():
    made = ProcessPort()
    yield made
    made.connecting_side.close()
    made.accepting_side.close()


def test_who_connects_first_is_accepted_first_with_what_it_is_about(port):
    assert (port.has_connection(), accept(port.accepting_side)) == (False, None)
    for subject in (b"one", b"other"):
        with connect(port.connecting_side, subject) as sock:
            sock.send(subject)
    for subject in (b"one", b"other"):
        assert port.has_connection()
        sock, about = accept(port.accepting_side)
        with sock:
            assert (about, sock.recv(8), sock.recv(8)) == (subject, subject, b"")
            assert not os.get_inheritable(sock.fileno())
    assert not port.has_connection()


def fill(port, waiting):
    while len(waiting) < 1 << 12:
        waiting.append(connect(port.connecting_side))


def test_a_full_port_refuses_and_has_room_again(port):
    waiting = []
    with pytest.raises(BlockingIOError):
        fill(port, waiting)
    accept(port.accepting_side)[0].close()
    waiting.append(connect(port.connecting_side))
    assert waiting[0].recv(1) == b"", "the one that was accepted is closed"
    for sock in waiting:
        sock.close()
