"""What one replica's throttles count, another's count too; over a real PostgreSQL."""

from contextlib import closing, contextmanager
from threading import Thread

import pg8000.dbapi
import pytest
from harness import wait_for
from pydantic import TypeAdapter
from service_app import ManualClock
from sqlalchemy import make_url, text

from rtron.service.replicas.notice_listener import NoticeListener
from rtron.service.replicas.shared_throttles import SharedThrottles
from rtron.service.store.database import Database
from rtron.service.store.notices import Envelope, TokensNotice

FREE = 5


def ignore():
    """Do nothing."""


@contextmanager
def telling(throttles):
    thread = Thread(target=throttles.queue.run)
    thread.start()
    try:
        yield
    finally:
        throttles.queue.close()
        thread.join()


@contextmanager
def listening(database, throttles):
    heard = []

    def note(notices):
        for each in notices:
            throttles.note(each)
        heard.extend(notices)

    listener = NoticeListener(database, ignore, note, ignore)
    listener.start()
    wait_for(lambda: listener.is_connected)
    try:
        yield heard
    finally:
        listener.close()


@pytest.fixture
def throttles(postgresql):
    """Give the throttles of two replicas, and what the second one has heard."""
    url, clock = postgresql.new_database(), ManualClock()
    with closing(Database(url)) as here, closing(Database(url)) as there:
        first, second = SharedThrottles(here, clock), SharedThrottles(there, clock)
        with listening(there, second) as heard, telling(first):
            yield first, second, heard, clock


def test_wrong_codes_make_their_user_wait_everywhere_until_one_is_right(throttles):
    first, second, heard, clock = throttles
    for _ in range(FREE):
        assert first.codes.begin_attempt("mary", "", clock()) == 0
    wait_for(lambda: len(heard) == FREE)
    assert second.codes.begin_attempt("mary", "", clock()) > 0
    assert second.codes.begin_attempt("john", "", clock()) == 0
    first.codes.record_success("mary", "")
    wait_for(lambda: len(heard) == FREE + 1)
    assert second.codes.begin_attempt("mary", "", clock()) == 0


def test_failed_logins_make_their_address_wait_everywhere(throttles):
    first, second, heard, clock = throttles
    for number in range(FREE):
        assert first.logins.begin_attempt(f"user{number}", "10.0.0.1", clock()) == 0
    first.logins.begin_attempt("john", "10.0.0.2", clock())
    first.logins.cancel_attempt("john", "10.0.0.2")
    wait_for(lambda: len(heard) == FREE + 2)
    assert second.logins.begin_attempt("mary", "10.0.0.1", clock()) > 0
    assert second.logins.begin_attempt("mary", "10.0.0.2", clock()) == 0


STRANGER = "stranger"


def connect_as_stranger(url):
    """Connect as a role that may only connect, as every role may to every database."""
    with closing(Database(url)) as database, database.engine.begin() as connection:
        is_there = connection.scalar(text(f"SELECT 1 FROM pg_roles WHERE rolname = '{STRANGER}'"))
        if not is_there:
            connection.execute(text(f"CREATE ROLE {STRANGER} LOGIN"))
    place = make_url(url)
    return pg8000.dbapi.connect(STRANGER, place.host, place.database, place.port)


def test_who_may_only_connect_to_the_database_neither_forges_notices_nor_hears_any(throttles):
    first, _second, heard, clock = throttles
    url = first.queue._database.url.render_as_string(hide_password=False)
    with closing(connect_as_stranger(url)) as stranger:
        stranger.autocommit = True
        cursor = stranger.cursor()
        forged = Envelope(sender=0, number=1, notice=TokensNotice())
        payload = TypeAdapter(Envelope).dump_json(forged).decode()
        for channel in ("rtron", "notices", "replica"):
            cursor.execute(f"LISTEN {channel}")
            cursor.execute("SELECT pg_notify(%s, %s)", (channel, payload))
        with pytest.raises(pg8000.DatabaseError, match="permission denied"):
            cursor.execute("SELECT name FROM notice_channel")
        first.codes.begin_attempt("mary", "", clock())
        wait_for(lambda: heard)
        cursor.execute("SELECT 1")
        own = [text for _, _, text in stranger.notifications]
    assert [each.type for each in heard] == ["code"]
    assert own == [payload] * 3
