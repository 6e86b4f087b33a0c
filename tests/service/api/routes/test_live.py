import json
import time

import pytest
from harness import LIMIT_S, wait_for
from service_app import FakeLink
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from rtron.service.api.routes import live
from rtron.service.store.accounts.tokens import revoke_token
from rtron.service.store.accounts.users import get_user, set_disabled
from rtron.vocabulary import GuardState

MOVE = {"type": "connection", "robot": "car1", "connected": True}
EVENT = {"type": "event", "event": {"robot": "car1", "reason": "it moves"}}


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
        robots = {"car1": {"connected": True, "silent": False}}
        assert json.loads(socket.recv(timeout=60)) == {"type": "robots", "robots": robots}
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


NO_REQUESTS = (
    "x" * 1000,
    b"\xff",
    "{}",
    '{"robots": [], "events": false, "more": 1}',
    '{"robots": "car1", "events": false}',
    json.dumps({"robots": [f"car{n}" for n in range(51)], "events": False}),
    '{"robots": ["\\u0000"], "events": false}',
)


def test_what_is_no_request_changes_nothing(app, people, listening):
    headers = people.session_headers("mary", "end_user")
    for said in NO_REQUESTS:
        with listening(headers) as socket:
            wait_for_listener(app)
            socket.send(said)
            socket.send('{"robots": ["car2"], "events": true}')
            app.state.service.hub.broadcast(EVENT)
            assert json.loads(socket.recv(timeout=60)) == EVENT, said


def test_a_console_hears_of_the_robots_that_it_watches(app, people, listening):
    hub, link = app.state.service.hub, FakeLink()
    hub.register("car1", link, dry_run=False)
    hub.set_state("car1", link, GuardState(at=1, revision=7))
    with listening(people.session_headers("mary", "end_user")) as socket:
        wait_for_listener(app)
        socket.send('{"robots": ["car1"], "events": false}')
        whole = json.loads(socket.recv(timeout=60))
        assert (whole["type"], whole["state"]["revision"]) == ("state", 7)
        hub.broadcast({"type": "event", "event": {"robot": "car2"}})
        hub.broadcast(EVENT)
        assert json.loads(socket.recv(timeout=60)) == EVENT


def test_requests_are_read_one_after_the_other(app, monkeypatch, people, listening):
    monkeypatch.setattr(live, "_REQUEST_INTERVAL_S", 0.2)
    hub, link = app.state.service.hub, FakeLink()
    hub.register("car1", link, dry_run=False)
    hub.set_state("car1", link, GuardState(at=1, revision=7))
    with listening(people.session_headers("mary", "end_user")) as socket:
        wait_for_listener(app)
        begin = time.monotonic()
        for robots in (["car1"], [], ["car1"], [], ["car1"]):
            socket.send(json.dumps({"robots": robots, "events": False}))
        states = 0
        while states < 3:
            states += json.loads(socket.recv(timeout=60))["type"] == "state"
        assert time.monotonic() - begin >= 4 * 0.2
    hub.unregister("car1", link)


def test_there_are_not_too_many(app, monkeypatch, people, listening):
    monkeypatch.setattr(live, "_MAX_SOCKETS", 1)
    headers = people.session_headers("mary", "end_user")
    with listening(headers), pytest.raises(InvalidStatus, match="403"), listening(headers):
        pass
    wait_for(lambda: not app.state.sockets)
    with listening(headers):
        pass


def test_one_reader_does_not_take_all_places(app, monkeypatch, people, listening):
    monkeypatch.setattr(live, "_MAX_OWN_SOCKETS", 1)
    reader, mary = people.token_headers("wall", "read"), people.session_headers("mary", "end_user")
    with listening(reader), pytest.raises(InvalidStatus, match="403"), listening(reader):
        pass
    wait_for(lambda: not app.state.sockets)
    with listening(reader), listening(mary):
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
