"""What is forgotten on SQLite; of PostgreSQL tells `test_event_partitions.py`."""

import pytest
from sqlalchemy import func, select
from store_data import make_event, new_robot, prune, store_events

from rtron.service.domain.audit_events import AuditEvent
from rtron.service.store.audit import record_event
from rtron.service.store.database import Database
from rtron.service.store.retention import BATCH_EVENTS, RetentionLimits, used_bytes
from rtron.service.store.tables import AuditRow, EventRow, SettingsRow
from rtron.vocabulary import EventKind

DAY = 86_400_000_000_000
MUCH = 1 << 40


@pytest.fixture
def database(tmp_path):
    made = Database(tmp_path / "rtron.db")
    yield made
    made.close()


def remaining_events(database):
    with database.session() as session:
        return list(session.scalars(select(EventRow.number).order_by(EventRow.id)))


@pytest.mark.parametrize(
    "count", [1, BATCH_EVENTS - 1, BATCH_EVENTS, BATCH_EVENTS + 1, 2 * BATCH_EVENTS]
)
def test_what_is_too_old_goes_in_slices(database, count):
    robot = new_robot(database)
    store_events(database, robot, [make_event(n) for n in range(1, count + 1)], now=0)
    store_events(database, robot, [make_event(count + 1)], now=DAY)
    slices = list(prune(database, RetentionLimits(max_days=1, max_bytes=MUCH), 2 * DAY))
    assert remaining_events(database) == [count + 1]
    assert max(slices) <= BATCH_EVENTS
    assert sum(slices) == count


def test_age_is_by_the_clock_of_the_service(database):
    robot = new_robot(database)
    store_events(database, robot, [make_event(1, at=0), make_event(2, at=1 << 62)], now=3 * DAY)
    list(prune(database, RetentionLimits(max_days=1, max_bytes=MUCH), 4 * DAY))
    assert remaining_events(database) == [1, 2]
    list(prune(database, RetentionLimits(max_days=1, max_bytes=MUCH), 4 * DAY + 1))
    assert remaining_events(database) == []


def fill(database):
    robot = new_robot(database)
    for first in range(1, 6001, 1000):
        store_events(database, robot, [_event(number) for number in range(first, first + 1000)])


def _event(number):
    kind = EventKind.COUNTS if number % 2 else EventKind.VERDICT
    return make_event(number, kind=kind, reason="x" * 200, values={"streams": {}})


def size(database):
    with database.session() as session:
        return used_bytes(session)


def shrink(database, bound):
    """Forget, as the service does again and again, until what is used is within a bound."""
    for _ in range(50):
        list(prune(database, RetentionLimits(max_days=1000, max_bytes=bound), 2))
        if size(database) <= bound:
            return remaining_events(database)
    raise AssertionError("it does not become small enough")


@pytest.mark.parametrize("part", [0.9, 0.6, 0.3])
def test_too_much_takes_counts_first_and_the_oldest(database, part):
    fill(database)
    left = shrink(database, int(size(database) * part))
    counts = [number for number in left if number % 2]
    others = [number for number in left if not number % 2]
    assert 1000 * part < len(left) < 6000
    assert counts == list(range(6001 - 2 * len(counts), 6001, 2))
    assert others == list(range(6002 - 2 * len(others), 6001, 2))
    assert not counts or len(others) == 3000


def test_within_bounds_nothing_goes(database):
    fill(database)
    list(prune(database, RetentionLimits(max_days=1000, max_bytes=size(database)), 2))
    assert len(remaining_events(database)) == 6000


def test_settings_and_audit_stay(database):
    robot = new_robot(database)
    with database.session() as session:
        record_event(session, 0, AuditEvent(who="me", action="login", target=""))
        settings = {"by": "me", "reason": "", "outcome": "applied", "error": "", "answered": None}
        session.add(SettingsRow(app_id=1, revision=1, document={}, at=0, **settings))
    store_events(database, robot, [make_event(1)], now=0)
    list(prune(database, RetentionLimits(max_days=1, max_bytes=0), 1000 * DAY))
    assert remaining_events(database) == []
    with database.session() as session:
        for table in (AuditRow, SettingsRow):
            assert session.scalar(select(func.count()).select_from(table)) == 1


def test_others_write_between_slices(database):
    robot = new_robot(database)
    store_events(database, robot, [make_event(n) for n in range(1, 3 * BATCH_EVENTS)], now=0)
    slices = prune(database, RetentionLimits(max_days=1, max_bytes=MUCH), 2 * DAY)
    next(slices)
    store_events(database, robot, [make_event(3 * BATCH_EVENTS)], now=2 * DAY)
    list(slices)
    assert remaining_events(database) == [3 * BATCH_EVENTS]
