"""What was answered outlives a power cut: SQLite has waited for the disk."""

from contextlib import contextmanager

import pytest
from controller_setup import DEVELOPER, ControllerSetup, hello, plan

from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.database import Database

_NORMAL, _FULL = 1, 2


def synchronous(session):
    return session.connection().exec_driver_sql("PRAGMA synchronous").scalar()


@pytest.fixture
def database(tmp_path):
    made = Database(tmp_path / "rtron.db")
    yield made
    made.close()


def test_a_durable_transaction_waits_for_the_disk_the_next_does_not(database):
    for durable in (False, True, False, True):
        with database.write_session(durable=durable) as session:
            assert synchronous(session) == (_FULL if durable else _NORMAL)
        with database.session() as session:
            assert synchronous(session) == _NORMAL


def test_after_a_durable_one_that_failed_nothing_waits(database):
    with pytest.raises(RuntimeError), database.write_session(durable=True):
        raise RuntimeError
    with database.write_session() as session:
        assert synchronous(session) == _NORMAL


class Watched(Database):
    """Notes how each transaction was committed."""

    @contextmanager
    def session(self):
        with super().session() as session:
            yield session
            self.__dict__.setdefault("seen", []).append(synchronous(session))


def test_settings_are_stored_durably(tmp_path):
    world = ControllerSetup(Watched(tmp_path / "rtron.db"))
    world.controller.handle_hello("r2", hello(plan()))
    change = SettingsChange(revision=0, nodes={"drive": {"policy": "Block"}})
    world.controller.change(DEVELOPER, "r2", change)
    world.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert world.database.seen == [_FULL] * 3
    world.database.close()
