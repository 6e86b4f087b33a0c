"""Crowds of strangers, over real sockets: people and stops go on."""

import json
import socket
import ssl
from contextlib import ExitStack, closing, contextmanager, suppress
from functools import partial
from http.client import HTTPConnection
from queue import SimpleQueue
from select import select
from threading import Event, Thread

import httpx
import pytest
from fastapi.routing import APIRoute
from harness import wait_for
from service_app import PASSWORD, serve_in_thread
from websockets.sync.client import connect

from rtron.service.api.routes import monitoring
from rtron.service.config import ServiceConfig, Tls
from rtron.service.console.routes import digest
from rtron.service.server import connection_limit, http, http_protocol
from rtron.service.server.app import create_app
from rtron.service.server.connection_limit import ConnectionLimit

LIMIT_S = 120


def ask(port, method, path, headers=(), body=None, source="127.0.0.1"):
    """Return status and body of an answer."""
    connection = HTTPConnection("127.0.0.1", port, timeout=LIMIT_S, source_address=(source, 0))
    with_json = {"Content-Type": "application/json", **dict(headers)}
    connection.request(method, path, json.dumps(body) if body is not None else None, with_json)
    with connection.getresponse() as response:
        answer = response.status, response.read()
    connection.close()
    return answer


def test_silent_connections_from_everywhere_keep_nobody_out(app):
    with serve_in_thread(app) as port, ExitStack() as stack:
        for number in range(2500):
            source = f"127.0.{1 + number // 400}.1"
            silent = socket.create_connection(("127.0.0.1", port), LIMIT_S, (source, 0))
            stack.callback(silent.close)
        assert ask(port, "GET", "/healthz")[0] == 200


SLOW_BODY = (
    b"POST /api/v1/login HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
    b"Expect: 100-continue\r\nContent-Length: 9\r\n\r\n{"
)
UNREAD = f"GET /console/{digest()}/main.js HTTP/1.1\r\nHost: localhost\r\n\r\n".encode() * 100


@pytest.mark.parametrize(
    ("said", "is_answered"),
    [(b"", False), (b"GET / HTTP/1.1\r\n", False), (SLOW_BODY, True), (UNREAD, True)],
    ids=["nothing", "half a head", "half a body", "reads nothing"],
)
def test_connections_that_wait_for_their_clients_keep_nobody_out(
    app, monkeypatch, said, is_answered
):
    places = 20
    monkeypatch.setattr(http, "ConnectionLimit", partial(ConnectionLimit, max_connections=places))

    def answers():
        with suppress(OSError):
            return ask(port, "GET", "/healthz")[0] == 200

    with serve_in_thread(app) as port, ExitStack() as stack:
        for _ in range(places):
            hostile = stack.enter_context(closing(socket.socket()))
            hostile.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            hostile.connect(("127.0.0.1", port))
            hostile.sendall(said)
            if is_answered:
                assert hostile.recv(1)
        wait_for(answers, 8)


@pytest.fixture
def tls_config(tmp_path, certificate):
    return ServiceConfig(
        database=tmp_path / "tls.db", tls=Tls(cert=certificate[0], key=certificate[1])
    )


def has_ended(connection):
    readable, _, _ = select([connection], [], [], 0)
    return bool(readable) and not connection.recv(1)


def silent_connections(stack, port, number):
    return [
        stack.enter_context(socket.create_connection(("127.0.0.1", port), LIMIT_S))
        for _ in range(number)
    ]


def test_silent_connections_before_the_handshake_make_room(tls_config, certificate, monkeypatch):
    limited = partial(ConnectionLimit, max_connections=20)
    monkeypatch.setattr("service_app.ConnectionLimit", limited)
    trusted = ssl.create_default_context(cafile=certificate[0])
    with serve_in_thread(create_app(tls_config), tls_config) as port, ExitStack() as stack:
        silent = silent_connections(stack, port, 30)
        wait_for(lambda: sum(map(has_ended, silent)) == 10)
        for _ in range(5):
            url = f"https://localhost:{port}/healthz"
            assert httpx.get(url, verify=trusted, timeout=LIMIT_S).status_code == 200
            assert sum(map(has_ended, silent)) == 10 + 1


def test_a_handshake_has_its_time(tls_config, monkeypatch):
    monkeypatch.setattr(connection_limit, "HANDSHAKE_TIMEOUT_S", 0.5)
    with serve_in_thread(create_app(tls_config), tls_config) as port, ExitStack() as stack:
        silent = silent_connections(stack, port, 20)
        wait_for(lambda: all(map(has_ended, silent)))
        assert not connection_limit._handshaking


def test_an_address_has_so_many_handshakes(tls_config, monkeypatch):
    monkeypatch.setattr(connection_limit, "MAX_PER_TRUSTED_ADDRESS", 20)
    with serve_in_thread(create_app(tls_config), tls_config) as port, ExitStack() as stack:
        silent = silent_connections(stack, port, 25)
        wait_for(lambda: sum(map(has_ended, silent)) == 5)


def test_a_connection_whose_answers_nobody_reads_ends(app, monkeypatch):
    monkeypatch.setattr(http_protocol, "_READER_TIMEOUT_S", 0.2)
    limit = ConnectionLimit(())
    monkeypatch.setattr(http, "ConnectionLimit", lambda _proxies: limit)
    with serve_in_thread(app) as port, closing(socket.socket()) as hostile:
        hostile.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        hostile.connect(("127.0.0.1", port))
        hostile.sendall(UNREAD)
        assert hostile.recv(1)
        wait_for(lambda: not limit._counts)


def test_handshakes_of_one_address_are_not_in_the_way_of_guards(app, people, monkeypatch):
    monkeypatch.setattr(connection_limit, "MAX_PER_TRUSTED_ADDRESS", 3)
    gate, asked, known = Event(), [], app.state.collector.authenticate

    def authenticate(token):
        asked.append(token)
        assert gate.wait(LIMIT_S)
        return known(token)

    object.__setattr__(app.state.collector, "authenticate", authenticate)
    wrong = (
        b"GET /link/v1 HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
        b"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nAuthorization: Bearer x\r\n"
        b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    with serve_in_thread(app) as port, ExitStack() as stack:
        strangers = []
        for _ in range(3):
            strangers += silent_connections(stack, port, 1)
            strangers[-1].sendall(wrong)
        wait_for(lambda: asked)
        (one_more,) = silent_connections(stack, port, 1)
        one_more.sendall(wrong)
        wait_for(lambda: _is_reset(one_more))
        gate.set()
        for each in strangers:
            assert each.recv(12) == b"HTTP/1.1 401"
        url, right = f"ws://127.0.0.1:{port}/link/v1", people.token_headers("g", "guard", robot="r")
        with connect(url, additional_headers=right, proxy=None, open_timeout=LIMIT_S):
            pass


def _is_reset(connection):
    try:
        return has_ended(connection)
    except ConnectionResetError:
        return True


def test_a_stop_passes_while_every_thread_of_requests_is_busy(app, people, robot):
    gate, busy = Event(), []

    def block():
        busy.append(1)
        gate.wait(LIMIT_S)

    app.router.routes.insert(0, APIRoute("/block", block))
    headers = people.session_headers("mary", "end_user")
    with serve_in_thread(app) as port:
        threads = [Thread(target=ask, args=(port, "GET", "/block")) for _ in range(60)]
        try:
            for thread in threads:
                thread.start()
            wait_for(lambda: len(busy) == 40)
            path = f"/api/v1/robots/{robot}/stop"
            status, body = ask(port, "POST", path, headers, {"reason": "fire"})
        finally:
            gate.set()
            for thread in threads:
                thread.join(LIMIT_S)
    assert status == 200, body
    assert json.loads(body)["settings"]["stop"]["reason"] == "fire"


@pytest.mark.usefixtures("real_password_hashing")
def log_in(port, source, password=PASSWORD, name="mary", cookie=""):
    """Return the status of a login, and the cookie by which the browser is known then."""
    connection = HTTPConnection("127.0.0.1", port, timeout=LIMIT_S, source_address=(source, 0))
    headers = {"Content-Type": "application/json"} | ({"Cookie": cookie} if cookie else {})
    body = json.dumps({"name": name, "password": password})
    connection.request("POST", "/api/v1/login", body, headers)
    with connection.getresponse() as response:
        cookies = [value for key, value in response.getheaders() if key == "set-cookie"]
        known = [each.partition(";")[0] for each in cookies if each.startswith("rtron-browser=")]
        response.read()
        status = response.status
    connection.close()
    return status, known[0] if known else ""


def test_a_guesser_behind_the_same_address_does_not_keep_a_user_out(app, people):
    """The office's only address, or a proxy that does not tell the clients' own."""
    people.add_user("mary", "end_user")
    people.add_user("eve", "end_user")
    with serve_in_thread(app) as port:
        status, mine = log_in(port, "127.0.9.1")
        assert (status, bool(mine)) == (200, True)
        assert log_in(port, "127.0.9.1", cookie=mine) == (200, "")  # it is known already
        assert [log_in(port, "127.0.9.1", "guess")[0] for _ in range(6)] == [401] * 5 + [429]
        assert log_in(port, "127.0.9.1")[0] == 429  # somebody who has only the address
        assert log_in(port, "127.0.9.1", cookie=mine)[0] == 200
        assert log_in(port, "127.0.9.9", cookie=mine)[0] == 200
        _, others = log_in(port, "127.0.9.2", name="eve")
        assert log_in(port, "127.0.9.1", cookie=others)[0] == 429  # known, but not as mary's


def test_the_cookie_of_a_known_browser_gives_no_more_guesses(app, people):
    people.add_user("mary", "end_user")
    with serve_in_thread(app) as port:
        _, mine = log_in(port, "127.0.9.1")
        sources = [f"127.0.8.{number}" for number in range(1, 7)]
        statuses = [log_in(port, source, "guess", cookie=mine)[0] for source in sources]
        assert statuses == [401] * 5 + [429]
        assert log_in(port, "127.0.9.3")[0] == 200


def test_guesses_of_other_names_keep_nobody_out_of_a_known_address(app, people):
    people.add_user("mary", "end_user")
    with serve_in_thread(app) as port:
        assert log_in(port, "127.0.9.1")[0] == 200
        for number in range(8):
            log_in(port, "127.0.9.1", "guess", name=f"user{number}")
        assert log_in(port, "127.0.9.1", name="user0")[0] == 429
        assert log_in(port, "127.0.9.1")[0] == 200


def test_guessers_from_500_addresses_do_not_keep_a_user_out(app, people):
    people.add_user("mary", "end_user")
    wrong, right = ({"name": "mary", "password": each} for each in ("wrong", PASSWORD))
    with serve_in_thread(app) as port:
        assert ask(port, "POST", "/api/v1/login", body=right, source="127.9.9.9")[0] == 200
        threads = [
            Thread(
                target=ask,
                args=(port, "POST", "/api/v1/login"),
                kwargs={"body": wrong, "source": f"127.1.{number // 250}.{1 + number % 250}"},
            )
            for number in range(500)
        ]
        for thread in threads:
            thread.start()
        answers = [
            ask(port, "POST", "/api/v1/login", body=right, source="127.9.9.9")[0] for _ in range(5)
        ]
        for thread in threads:
            thread.join(LIMIT_S)
    assert answers == [200] * 5


@pytest.fixture
def robot(app):
    from controller_setup import hello, plan  # noqa: PLC0415 - only here

    app.state.service.controller.handle_hello("r2", hello(plan()))
    return "r2"


def test_a_crowd_that_asks_whether_the_database_can_be_written_makes_one_write(app, monkeypatch):
    gate, writes = Event(), []

    @contextmanager
    def transaction(database, _lock_timeout_ms):
        writes.append(1)
        assert gate.wait(LIMIT_S)
        with database.session() as session:
            yield session

    monkeypatch.setattr(monitoring, "short_transaction", transaction)
    answers = SimpleQueue()
    with serve_in_thread(app) as port:
        threads = [
            Thread(target=lambda: answers.put(ask(port, "GET", "/readyz")[0])) for _ in range(60)
        ]
        for thread in threads:
            thread.start()
        wait_for(lambda: writes)
        assert ask(port, "GET", "/readyz/read")[0] == 200  # a thread is free for it
        gate.set()
        for thread in threads:
            thread.join(LIMIT_S)
    assert [answers.get_nowait() for _ in threads] == [200] * 60
    assert len(writes) < 60 // 2
