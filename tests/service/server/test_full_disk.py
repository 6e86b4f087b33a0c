"""A disk that is really full refuses events, not connections, and no stop; nothing is forgotten."""

import sqlite3
from contextlib import closing
from itertools import takewhile
from threading import Thread

import pytest
from failing_database import read_only
from full_disks import LimitedFiles, LimitedServer, SmallFileSystem, can_mount, closing_disk
from harness import wait_for
from postgresql_server import PostgreSQL, programs
from replica_processes import Person, SimulatedGuard, create_secret
from service_app import PASSWORD
from sqlalchemy import event, text
from store_data import make_verdict, new_robot, store_events

from rtron.service.store.database import Database
from rtron.vocabulary import GuardEvent, Plan
from rtron.wire.common.link_protocol import Events, EventsRefused, Hello, Stored

BATCH, MOST_BATCHES = 200, 100
ROBOTS = "car", "truck"


def secrets(database):
    """Make a token for a person and for the guard of each robot."""
    scopes = "read", "admin", "developer", "end_user"
    made = {name: create_secret(database, name, "guard", robot=name) for name in ROBOTS}
    return {"person": create_secret(database, "person", *scopes), **made}


@pytest.fixture(params=["limited files", "small file system"])
def sqlite_disk(request, tmp_path):
    if request.param == "small file system" and not can_mount(tmp_path):
        pytest.skip("this user may not mount a file system, even in a namespace of their own")
    seed = tmp_path / "copied"
    seed.mkdir()
    with closing(Database(seed / "rtron.db")) as database:
        tokens = secrets(database)
    kind = LimitedFiles if request.param == "limited files" else SmallFileSystem
    with closing_disk(kind(tmp_path, seed)) as disk:
        disk.tokens = tokens
        yield disk


@pytest.fixture(scope="module")
def own_server():
    """Run a PostgreSQL server whose files may be limited, but for those of its log (1 MB)."""
    if programs() is None:
        pytest.skip("Debian's postgresql is not installed: make setup")
    server = PostgreSQL("--wal-segsize=1")
    yield server
    server.stop()


@pytest.fixture
def postgresql_disk(own_server, tmp_path):
    url = own_server.new_database()
    with closing(Database(url)) as database:
        tokens = secrets(database)
        other = new_robot(database, "other")
        events = [make_verdict(number, reason="x" * 900) for number in range(1, 1501)]
        store_events(database, other, events, robot="other")

        def table_bytes():
            with database.session() as session:
                return session.scalar(text("SELECT pg_relation_size('events_p0')"))

        assert table_bytes() > 1 << 20
        with closing_disk(LimitedServer(tmp_path, own_server, url, table_bytes)) as disk:
            disk.tokens = tokens
            yield disk


class Robot:
    """A guard with a spool of events: what is not acknowledged comes again."""

    def __init__(self, disk, name):
        self.guard = SimulatedGuard(
            disk.service, name, disk.tokens[name], takes_refusals=True, takes_audit_heads=False
        )
        self.sent = self.acknowledged = 0

    def send(self):
        """Send a batch behind what is acknowledged; tell whether it is stored."""
        numbers = range(self.acknowledged + 1, self.acknowledged + 1 + BATCH)
        self.sent = max(self.sent, numbers[-1])
        self.guard.send(Events(events=tuple(map(_event, numbers))))
        while isinstance(answer := self.guard.receive((Stored, EventsRefused)), Stored):
            self.acknowledged = answer.number
            if self.acknowledged == numbers[-1]:
                return True
        return False


def _event(number):
    made = make_verdict(number, reason=f"event {number} " + "x" * 900)
    assert isinstance(made, GuardEvent)
    return made


def stored_numbers(person):
    numbers, query = [], "limit=1000&robot=car&kind=verdict"
    page = person.ask(f"/events?{query}").json()
    while True:
        numbers += [int(event["reason"].split()[1]) for event in page["events"]]
        if page["next"] is None:
            return sorted(numbers)
        page = person.ask(f"/events?{query}&before={page['next']}").json()


def _check(disk):
    person = Person(disk.service, disk.tokens["person"])
    with closing(person):
        car = Robot(disk, "car")
        assert car.send()
        disk.fill()
        taken = sum(takewhile(bool, (car.send() for _ in range(MOST_BATCHES))))
        assert taken < MOST_BATCHES, "the disk takes everything"
        car.guard.tell_state(fps={"eyes": 12.5})
        wait_for(lambda: (person.robot("car")["state"] or {}).get("fps") == {"eyes": 12.5})
        assert stored_numbers(person) == list(range(1, car.acknowledged + 1))
        answer = person.stop("car", "smoke")
        assert answer.status_code == 200 or "the stop is sent, but not stored" in answer.text
        assert car.guard.receive_settings().stop.reason == "smoke"
        assert Robot(disk, "truck").guard.settings.stop is None
        assert not car.send()
        disk.free()
        wait_for(car.send, what="the events after the disk is free again")
        assert stored_numbers(person) == list(range(1, car.acknowledged + 1))
        person.stop("car", "smoke")
        assert person.robot("car")["stop"]["reason"] == "smoke"
        car.guard.close()


def test_a_full_disk_of_sqlite(sqlite_disk):
    _check(sqlite_disk)


def test_a_full_disk_of_postgresql(postgresql_disk):
    _check(postgresql_disk)


NEVER_MS = 3_600_000


class RecordingLink:
    """A guard's connection that keeps what is sent."""

    def __init__(self):
        self.pushed = []

    def push(self, settings):
        self.pushed.append(settings)


@pytest.fixture
def database(app):
    return app.state.service.database


@pytest.fixture
def car1(app):
    hello = Hello(app="app", plan=Plan(app="app"), run="r", began=1, version="1")
    app.state.service.controller.handle_hello("car1", hello)


def test_reading_goes_on(client, database, people, clock, caplog):
    browser, program = people.session_headers("mary", "end_user"), people.token_headers("t", "read")
    clock.sleep(100)
    with read_only(database):
        for headers in (browser, program, browser):
            assert client.get("/api/v1/robots", headers=headers).status_code == 200
        said = [each for each in caplog.messages if "last use" in each]
        assert len(said) <= 1
        refused = client.post(
            "/api/v1/users", json={"name": "x", "password": PASSWORD, "roles": []}, headers=browser
        )
        assert refused.status_code in {403, 422, 503}


def test_a_guard_is_let_in(app, database, people, clock):
    token = people.token_headers("car1", "guard", robot="car1")["Authorization"].split()[1]
    with read_only(database):
        assert app.state.collector.authenticate(token) == "car1"


@pytest.mark.usefixtures("car1")
def test_the_stop_is_sent(app, client, database, people, clock):
    headers = people.session_headers("mary", "end_user")
    clock.sleep(100)
    link = RecordingLink()
    app.state.service.hub.register("car1", link, dry_run=False)
    with read_only(database):
        answer = client.post("/api/v1/robots/car1/stop", headers=headers)
    assert answer.status_code == 503
    assert "the stop is sent, but not stored" in answer.json()["error"]
    assert [settings.stop.by for settings in link.pushed] == ["mary"]


@pytest.mark.usefixtures("car1")
def test_a_stop_for_a_robot_that_is_away_is_not_said_to_be_sent(client, database, people, clock):
    headers = people.session_headers("mary", "end_user")
    clock.sleep(100)
    with read_only(database):
        answer = client.post("/api/v1/robots/car1/stop", headers=headers)
    assert answer.status_code == 503
    assert "the stop waits for the robot, and is not stored" in answer.json()["error"]


def test_it_is_ready_while_it_can_write(client, database, admin):
    before = client.get("/api/v1/audit", headers=admin).json()
    assert client.get("/readyz").status_code == 200
    with read_only(database):
        assert client.get("/readyz").status_code == 503
        assert client.get("/healthz").status_code == 200
    assert client.get("/readyz").status_code == 200
    assert client.get("/api/v1/audit", headers=admin).json() == before


def test_a_lock_is_not_waited_for_to_note_a_use(client, database, people, clock):
    """Whoever waits for it does so for longer than the test."""
    headers = people.session_headers("mary", "end_user")
    clock.sleep(100)
    event.listen(database.engine, "connect", wait_for_ever)
    database.engine.dispose()
    with closing(sqlite3.connect(database.url.database, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        answers = []

        def ask():
            for path in ("/api/v1/robots", "/readyz"):
                answers.extend((client.get(path, headers=headers).status_code,))

        asks = Thread(target=ask)
        asks.start()
        try:
            wait_for(lambda: len(answers) == 2, what="answers meanwhile", show=lambda: answers)
        finally:
            other.execute("ROLLBACK")
            asks.join()
    assert answers == [200, 503]
    with database.session() as session:
        waits = session.connection().exec_driver_sql("PRAGMA busy_timeout").scalar_one()
    assert waits == NEVER_MS


def wait_for_ever(connection, _record):
    """Let a connection of SQLite wait for a lock until it is free."""
    connection.execute(f"PRAGMA busy_timeout = {NEVER_MS:d}")
