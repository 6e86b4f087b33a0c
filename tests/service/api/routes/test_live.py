import json

import pytest
from harness import LIMIT_S, wait_for
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from rtron.service.api.routes import live
from rtron.service.store.accounts.tokens import revoke_token
from rtron.service.store.accounts.users import get_user, set_disabled

MOVE = {"type": "connection", "robot": "car1", "connected": True}


@pytest.fixture
def listening(port, app):
    """Return a function that opens a live socket with somebody's headers."""

    def opened(headers):
        url = f"ws://127.0.0.1:{port}/api/v1/live"
        origin = f"http://127.0.0.1:{port}"
        return connect(
            url, origin=origin, additional_headers=headers, proxy=None, open_timeout=LIMIT_S
        )

    return opened


def wait_for_listener(app):
    wait_for(lambda: len(app.state.sockets) == 1 and len(app.state.service.hub._listeners) == 2)


def close_code(socket):
    """Return the code that a socket is closed with."""
    with pytest.raises(ConnectionClosed) as closed:
        drain(socket)
    return closed.value.rcvd.code


def drain(socket):
    while True:
        socket.recv(timeout=60)


def test_what_is_live_is_told(app, people, listening):
    with listening(people.session_headers("mary", "end_user")) as socket:
        wait_for_listener(app)
        app.state.service.hub.broadcast(MOVE)
        assert json.loads(socket.recv(timeout=60)) == MOVE
    wait_for(lambda: not app.state.sockets)
    wait_for(lambda: len(app.state.service.hub._listeners) == 1)


def test_it_ends_with_the_session(app, client, people, listening):
    headers = people.session_headers("mary", "end_user")
    with listening(headers) as socket:
        wait_for_listener(app)
        assert client.post("/api/v1/logout", headers=headers).status_code == 204
        assert close_code(socket) == 1008


def test_it_ends_when_the_user_is_disabled(app, admin, people, listening):
    with listening(people.session_headers("mary", "end_user")) as socket:
        with app.state.service.database.session() as session:
            set_disabled(session, get_user(session, "mary"), disabled=True)
        assert close_code(socket) == 1008


def test_it_ends_when_the_session_is_too_old(app, clock, people, listening):
    with listening(people.session_headers("mary", "end_user")) as socket:
        clock.sleep(13 * 3600)
        assert close_code(socket) == 1008


def test_it_ends_with_the_token(app, clock, people, listening):
    with listening(people.token_headers("t", "read")) as socket:
        with app.state.service.database.session() as session:
            revoke_token(session, clock(), "t.0")
        assert close_code(socket) == 1008


def test_a_console_that_talks_is_not_listened_to(app, people, listening):
    with listening(people.session_headers("mary", "end_user")) as socket:
        wait_for_listener(app)
        socket.send("x" * 1000)
        socket.send(b"\xff")
        app.state.service.hub.broadcast(MOVE)
        assert json.loads(socket.recv(timeout=60)) == MOVE


def test_there_are_not_too_many(app, monkeypatch, people, listening):
    monkeypatch.setattr(live, "_MAX_SOCKETS", 1)
    headers = people.session_headers("mary", "end_user")
    with listening(headers), pytest.raises(InvalidStatus, match="403"), listening(headers):
        pass
    wait_for(lambda: not app.state.sockets)
    with listening(headers):
        pass


def test_an_open_console_is_no_use_of_the_session(app, clock, monkeypatch, people, listening):
    monkeypatch.setattr(live, "_SESSION_CHECK_INTERVAL_S", 0.01)
    check, checks = live._check_read_permission, []

    def counted(*arguments):
        checks.append(clock())
        return check(*arguments)

    monkeypatch.setattr(live, "_check_read_permission", counted)
    headers = people.session_headers("mary", "end_user")
    with listening(headers) as socket:
        wait_for_listener(app)
        for _ in range(6):
            clock.sleep(0.4 * 3600)
            app.state.service.hub.broadcast(MOVE)
            now = clock()
            wait_for(lambda now=now: checks.count(now) > 1 or not app.state.sockets)
        assert close_code(socket) == 1008
