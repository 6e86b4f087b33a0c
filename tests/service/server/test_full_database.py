"""What goes on while nothing can be written: the disk is full, or somebody holds the lock."""

import sqlite3
from contextlib import closing
from threading import Thread

import pytest
from failing_database import read_only
from harness import wait_for
from service_app import PASSWORD
from sqlalchemy import event

from rtron.vocabulary import Plan
from rtron.wire.common.link_protocol import Hello

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
