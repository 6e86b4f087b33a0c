"""What a process of the guard does where there is no cell."""

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
