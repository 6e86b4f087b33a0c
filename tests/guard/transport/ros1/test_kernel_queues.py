"""What the kernel does not tell of a connection is not known: it is not zero."""

import socket
from contextlib import closing

import pytest

from rtron.guard.transport.ros1.subscriber_link import KernelQueues


@pytest.fixture
def queues():
    with closing(KernelQueues()) as queues:
        yield queues


@pytest.fixture
def connection():
    with socket.create_server(("127.0.0.1", 0)) as server:
        near = socket.create_connection(server.getsockname())
        far, _ = server.accept()
        with near, far:
            yield near


def test_what_waits_at_the_other_end_is_told(queues, connection):
    connection.send(b"12345")
    assert queues.untaken(connection) == 5


def test_without_an_answer_it_is_not_known(queues, connection):
    connection.send(b"12345")
    queues._diag.close()
    assert queues.untaken(connection) is None


def test_of_a_closed_socket_it_is_not_known(queues, connection):
    connection.close()
    assert queues.untaken(connection) is None
