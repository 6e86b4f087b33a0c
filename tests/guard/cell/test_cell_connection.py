"""What a process of the guard does where there is no cell."""

import os
import socket
from concurrent.futures import ThreadPoolExecutor

import pytest

from rtron.guard.cell import connection
from rtron.guard.cell.access import WATCH, CellAccess
from rtron.guard.cell.connection import CellConnection
from rtron.guard.core.event_loop import EventLoop

ADDRESS = "http://elsewhere:11311/"


@pytest.fixture
def loop():
    loop = EventLoop()
    yield loop
    loop.close()


def test_a_cell_that_is_not_there_is_told_once_with_its_master(loop, monkeypatch, caplog):
    monkeypatch.setattr(connection, "_RETRY_S", 0.001)
    looks = []

    class CountedAccess(CellAccess):
        def watch(self, kind):
            looks.append(kind)
            if len(looks) == 60:
                loop.post(loop.stop)
            return super().watch(kind)

    cell = CellConnection(loop, CountedAccess(ADDRESS, "/base"), lambda _: None, role=WATCH)
    loop.call_later(20, loop.stop)
    loop.run()
    cell.close()
    assert len(looks) >= 60
    assert [f"there is no cell of /base at {ADDRESS}" in each for each in caplog.messages] == [True]


def test_no_program_that_a_process_starts_gets_a_socket_of_the_cell(tmp_path):
    access = CellAccess(ADDRESS, "/base")
    access.paths = (tmp_path / "cell",)
    with (
        socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as cell,
        socket.socket() as inside,
        ThreadPoolExecutor(1) as worker,
    ):
        cell.bind(str(access.paths[0]))
        cell.listen()
        opened = worker.submit(access.open_socket)
        client, _ = cell.accept()
        with client:
            socket.send_fds(client, [b"-"], [inside.fileno()])
            with opened.result() as sock:
                assert not os.get_inheritable(sock.fileno())
