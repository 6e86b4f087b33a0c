"""What was answered outlives a power cut: SQLite has waited for the disk."""

from contextlib import contextmanager
from threading import Thread

import pytest
from controller_setup import DEVELOPER, ControllerSetup, hello, plan, plan_with
from harness import wait_for

from rtron.service.domain.schemas import SettingsChange
from rtron.service.store.database import Database

_NORMAL, _FULL = 1, 2
_LIMIT_S = 120


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
    """Notes how each transaction that writes was committed."""

    @contextmanager
    def write_session(self, **options):
        with super().write_session(**options) as session:
            yield session
            self.__dict__.setdefault("seen", []).append(synchronous(session))


def test_settings_are_stored_durably(tmp_path):
    world = ControllerSetup(Watched(tmp_path / "rtron.db"))
    world.controller.handle_hello("r2", hello(plan()))
    change = SettingsChange(revision=0, nodes={"drive": {"policy": "Block"}}, reason="why")
    world.controller.change(DEVELOPER, "r2", change)
    world.controller.start_emergency_stop(DEVELOPER, "r2", "fire")
    assert world.database.seen == [_FULL] * 3
    world.database.close()


def test_a_hello_that_says_nothing_new_does_not_wait_for_the_disk(tmp_path):
    world = ControllerSetup(Watched(tmp_path / "rtron.db"))
    for _ in range(2):
        world.controller.handle_hello("r2", hello(plan()))
    world.controller.handle_hello("r2", hello(plan_with("small", "other"), app="other"))
    assert world.database.seen == [_FULL, _NORMAL, _FULL]
    world.database.close()


def test_an_urgent_transaction_goes_before_those_that_wait(database):
    order, waiting = [], []

    def write(name, *, urgent):
        with database.write_session(urgent=urgent):
            order.append(name)

    with database.write_session():
        for name, urgent in (("events", False), ("stop", True), ("hello", False)):
            waiting.append(Thread(target=write, args=(name,), kwargs={"urgent": urgent}))
            waiting[-1].start()
        waiters = database._writer._changed._waiters
        wait_for(lambda: len(waiters) == len(waiting), what="all that wait", show=lambda: waiters)
    for thread in waiting:
        thread.join(_LIMIT_S)
    assert order[0] == "stop"
    assert sorted(order) == ["events", "hello", "stop"]
