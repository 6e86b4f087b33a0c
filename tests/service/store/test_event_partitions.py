"""PostgreSQL's events in partitions, on a real server: nothing is lost or doubled meanwhile."""

from threading import Event, Thread

import pytest
from harness import wait_for
from service_app import SIGNER
from sqlalchemy import func, select, text
from sqlalchemy.exc import DBAPIError
from store_data import SECOND, age_partitions, make_event, new_robot, prune, store_events

from rtron.service.store import event_pages
from rtron.service.store.chain_check import check_database, snapshot
from rtron.service.store.database import Database
from rtron.service.store.event_pages import EventFilter, event_page
from rtron.service.store.partitions import partition_pruning
from rtron.service.store.partitions.event_partitions import (
    ID_BITS,
    begin_partition,
    current_partition,
    drop_partition,
    event_count,
    finish_dropping,
    partition_bytes,
    partition_numbers,
    stored_count,
)
from rtron.service.store.retention import RetentionLimits, used_bytes
from rtron.service.store.tables import ChainLinkRow, EventRow, EventRunRow
from rtron.vocabulary import EventKind

DAY = 86_400_000_000_000
MUCH = 1 << 40


@pytest.fixture
def url(postgresql):
    return postgresql.new_database()


@pytest.fixture
def database(url):
    made = Database(url)
    yield made
    made.close()


@pytest.fixture
def connection(database):
    """The connection of somebody who changes partitions."""
    with database.own_connection(60) as made:
        yield made


@pytest.fixture
def robot(database):
    return new_robot(database)


def numbers(database):
    """The stored events in the order of storing."""
    with database.session() as session:
        return list(session.scalars(select(EventRow.number).order_by(EventRow.id)))


def ids(database):
    with database.session() as session:
        return list(session.scalars(select(EventRow.id).order_by(EventRow.id)))


def forget(database, now, days=1.0, size=MUCH):
    return list(prune(database, RetentionLimits(max_days=days, max_bytes=size), now))


def faults(database):
    with snapshot(database) as session:
        report = check_database(session, {}, {SIGNER.public_key})
    return [*report.faults, *(fault for chain in report.chains for fault in chain.faults)]


def store(database, robot, *wanted, now=1, kind=EventKind.OWNER, **values):
    return store_events(database, robot, [make_event(n, kind=kind, **values) for n in wanted], now)


def test_ids_count_up_from_partition_to_partition(database, connection, robot):
    for number in range(1, 7):
        store(database, robot, number)
        if number % 2 == 0:
            begin_partition(connection)
    assert numbers(database) == [1, 2, 3, 4, 5, 6]
    assert partition_numbers(connection) == [0, 1, 2, 3, 4]
    assert [event_count(connection, number) for number in range(4)] == [2, 2, 2, 0]
    assert stored_count(ids(database)[-1]) == 6
    assert max(ids(database)) < 1 << 53


INSERT_TWO = """
    INSERT INTO events (robot_id, run, number, at, stored, kind, level, node, topic, flow,
        publisher, policy, decision, reason, revision, values)
    SELECT :robot, 'run', n, n, 1, 'owner', 'info', '', '', '', '', '', '', '', 0, '{}'
    FROM generate_series(1, 2) AS n WHERE n = 1 OR pg_advisory_xact_lock(7) IS NOT NULL
"""
"""Stores one event, waits for whoever holds lock 7, and stores another one."""
WAITING = "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND NOT granted"


@pytest.mark.parametrize("begun", [1, 2])
def test_an_insert_under_way_goes_on_in_a_partition_that_begins(database, connection, robot, begun):
    for _ in range(begun - 1):
        begin_partition(connection)
    connection.exec_driver_sql("SELECT pg_advisory_lock(7)")
    with database.own_connection(60) as other:
        insert = Thread(target=other.execute, args=(text(INSERT_TWO), {"robot": robot}))
        insert.start()
        wait_for(lambda: connection.exec_driver_sql(WAITING).scalar(), what="the first event")
        begin_partition(connection)
        connection.exec_driver_sql("SELECT pg_advisory_unlock(7)")
        insert.join(60)
    assert numbers(database) == [1, 2]
    assert [each >> ID_BITS for each in ids(database)] == [begun - 1, begun]


def test_what_comes_again_is_stored_once_whatever_partition_it_is_in(database, robot):
    assert len(store(database, robot, *range(1, 11))) == 10
    age_partitions(database)
    assert [row["number"] for row in store(database, robot, *range(5, 16))] == [11, 12, 13, 14, 15]
    age_partitions(database)
    assert store(database, robot, *range(1, 16)) == []
    assert numbers(database) == list(range(1, 16))


def test_what_was_left_out_is_stored_later(database, robot):
    """Of two batches the first could not be stored: its numbers are below the highest one."""
    store(database, robot, 8, 9, 10)
    age_partitions(database)
    assert len(store(database, robot, *range(1, 11))) == 7
    assert sorted(numbers(database)) == list(range(1, 11))
    assert store(database, robot, *range(1, 11)) == []


def test_runs_and_robots_have_numbers_of_their_own(database, robot):
    other = new_robot(database, "other")
    events = [make_event(1), make_event(1, run="second"), make_event(1)]
    assert len(store_events(database, robot, events)) == 2
    assert len(store_events(database, other, events, robot="other")) == 2


def test_old_partitions_are_dropped_as_a_whole(database, connection, robot):
    for day in range(8):
        store(database, robot, *range(10 * day + 1, 10 * day + 11), now=day * DAY)
        evening = (day + 1) * DAY - 1
        assert forget(database, evening, days=3) == ([10] if day >= 3 else [])
        assert forget(database, evening, days=3) == []
    assert numbers(database) == list(range(51, 81))
    assert forget(database, 30 * DAY, days=3) == [10, 10]
    assert numbers(database) == list(range(71, 81))
    assert faults(database) == []


def test_a_partition_is_begun_when_it_is_time_and_not_before(database, connection, robot):
    forget(database, 0, days=30)
    assert current_partition(connection) == 0
    store(database, robot, 1, now=0)
    forget(database, DAY - 1, days=30)
    assert current_partition(connection) == 0
    forget(database, DAY, days=30)
    assert current_partition(connection) == 1
    forget(database, 100 * DAY, days=30)
    assert current_partition(connection) == 1


def test_too_much_takes_the_oldest_partitions(database, connection, robot):
    for part in range(6):
        new = range(1000 * part + 1, 1000 * part + 1001)
        store(database, robot, *new, kind=EventKind.COUNTS, reason="x" * 200)
        begin_partition(connection)
    with database.session() as session:
        used = used_bytes(session)
    bound = used - partition_bytes(connection, 0) - partition_bytes(connection, 1) // 2
    assert forget(database, 2, days=1000, size=bound) == [1000, 1000]
    assert numbers(database) == list(range(2001, 6001))
    forget(database, 2, days=1000, size=0)
    assert len(partition_numbers(connection)) == 3  # the next one too


def test_a_clock_that_is_set_refuses_no_event(database, connection, robot):
    for number, now in enumerate((5 * DAY, 0, 900 * DAY, 2 * DAY), 1):
        store(database, robot, number, now=now)
        forget(database, now, days=30)
    assert numbers(database) == [1, 2, 3, 4]


def test_what_is_known_of_runs_goes_with_their_events(database, robot):
    store(database, robot, 1, 2, run="old", now=0)
    store(database, robot, 1, run="both", now=0)
    age_partitions(database)
    store(database, robot, 2, run="both", now=DAY)
    assert sum(forget(database, 2 * DAY)) == 3
    with database.session() as session:
        assert list(session.scalars(select(EventRunRow.run))) == ["both"]
        links = session.scalar(select(func.count()).select_from(ChainLinkRow))
    assert links == 1
    assert faults(database) == []


def test_a_drop_that_was_cut_off_is_finished(database, connection, robot):
    for part in range(3):
        store(database, robot, part + 1, now=0)
        age_partitions(database)
    connection.exec_driver_sql("ALTER TABLE events DETACH PARTITION events_p0 CONCURRENTLY")
    with snapshot(database) as session:
        session.execute(select(EventRow.id)).all()
        connection.exec_driver_sql("SET lock_timeout = '200ms'")
        with pytest.raises(DBAPIError, match="lock timeout"):
            drop_partition(connection, 2)
    finish_dropping(connection)
    assert 0 not in partition_numbers(connection)
    assert 2 not in partition_numbers(connection)
    left = text("SELECT count(*) FROM pg_class WHERE relname IN ('events_p0', 'events_p2')")
    assert connection.scalar(left) == 0
    store(database, robot, 4)
    assert numbers(database) == [3, 4]


def test_one_replica_at_a_time_changes_partitions(database, connection, robot):
    store(database, robot, 1, now=0)
    with partition_pruning._exclusive(database) as holder:
        assert holder is not None
        assert forget(database, 100 * DAY) == []
        assert current_partition(connection) == 0
    # PostgreSQL frees the lock a moment after the holder's connection has ended
    wait_for(lambda: forget(database, 100 * DAY) or current_partition(connection) == 1)


@pytest.mark.parametrize("span", [1, 2, 3, 7, 100])
def test_a_search_goes_on_over_partitions(database, robot, monkeypatch, span):
    monkeypatch.setattr(event_pages, "MAX_SEARCHED_EVENTS", span)
    for number in range(1, 8):
        store(database, robot, number, reason="needle")
        age_partitions(database)
    found, before, calls = [], None, 0
    while calls == 0 or before is not None:
        with database.session() as session:
            page = event_page(session, EventFilter(text="needle", before=before))
        found += [event.at // SECOND for event in page.events]
        before, calls = page.next, calls + 1
        assert calls <= 8
    assert found == list(range(7, 0, -1))


class Writer:
    """A replica that stores the events of a guard, some of them again, until it is stopped."""

    def __init__(self, url, robot, stop):
        self.database, self.stored = Database(url), []
        self._robot, self._stop = robot, stop
        self.batches, self.failure = 0, None
        self.thread = Thread(target=self._run)

    def _run(self):
        try:
            number = 1
            while not self._stop.is_set():
                batch = range(max(1, number - 10), number + 20)
                rows = store(self.database, self._robot, *batch, now=50 * DAY)
                self.stored += [row["number"] for row in rows]
                number = batch[-1] + 1
                self.batches += 1
        except Exception as error:  # noqa: BLE001 - told in the test's thread
            self.failure = error
        finally:
            self.database.close()


def wait_until_all_write(writers):
    """Wait until each has begun and stored a batch since: partitions are hours apart."""
    before = [writer.batches for writer in writers]
    for writer, count in zip(writers, before, strict=True):
        wait_for(lambda w=writer, n=count: w.batches > n + 1 or w.failure, what="events")


def test_nothing_is_lost_or_doubled_while_partitions_come_and_go(url, database, connection, robot):
    old = 0
    for _ in range(6):
        old += len(store(database, robot, *range(old + 1, old + 101), run="old", now=0))
        begin_partition(connection)
    begin_partition(connection)
    stop = Event()
    writers = [Writer(url, robot, stop) for _ in range(3)]
    for writer in writers:
        writer.thread.start()
    dropped = 0
    for _ in range(13):
        begin_partition(connection)
        wait_until_all_write(writers)
        dropped += sum(forget(database, 60 * DAY, days=30))  # which begins another one
        wait_until_all_write(writers)
    stop.set()
    for writer in writers:
        writer.thread.join(60)
    assert [writer.failure for writer in writers] == [None] * 3
    assert dropped == old
    stored = sorted(number for writer in writers for number in writer.stored)
    assert stored == list(range(1, len(stored) + 1))
    assert sorted(numbers(database)) == stored
    assert len(partition_numbers(connection)) > 20
    assert faults(database) == []
