import http.client
import json
import socket
from itertools import accumulate

import pytest
from harness import LIMIT_S, wait_for
from service_app import AccountFactory, open_app, serve_in_thread
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from cpu_time import growth
from rtron.service.api.middleware import request_body
from rtron.service.api.middleware.request_body import (
    MAX_BODY_BYTES,
    MAX_DEPTH,
    MAX_GRAPH_BYTES,
    MAX_STRANGER_BYTES,
    is_too_deep,
)
from rtron.service.api.middleware.request_checks import parse_host_name
from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.service.server.connection_limit import MAX_PER_ADDRESS as MOST_OF_ONE
from rtron.service.server.connection_limit import MAX_PER_TRUSTED_ADDRESS, ConnectionLimit

HEADERS = {
    "content-security-policy",
    "x-content-type-options",
    "x-frame-options",
    "referrer-policy",
    "permissions-policy",
    "cross-origin-opener-policy",
    "cross-origin-resource-policy",
}


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    with open_app(ServiceConfig(database=tmp_path_factory.mktemp("gates") / "rtron.db")) as app:
        yield app


@pytest.fixture(scope="module")
def port(app):
    with serve_in_thread(app) as port:
        yield port


@pytest.fixture(scope="module")
def people(app):
    return AccountFactory(app.state.service)


@pytest.fixture
def own_app(tmp_path):
    with open_app(ServiceConfig(database=tmp_path / "rtron.db")) as app:
        yield app


@pytest.fixture
def raw(port):
    """Send bytes and return the head of the answer, until the other side closes or is done."""

    def send(*parts, close=True):
        with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
            for part in parts:
                sock.sendall(part)
            return http_answer(sock)

    return send


def http_answer(sock):
    response = http.client.HTTPResponse(sock)
    response.begin()
    return response.status, dict(response.getheaders()), response.read()


def chunk(data):
    return f"{len(data):x}\r\n".encode() + data + b"\r\n"


# hosts


@pytest.mark.parametrize(
    "host", ["localhost", "127.0.0.1", "[::1]", "LOCALHOST:80", "[::1]:8600", "127.0.0.1:1"]
)
def test_loopback_names_are_known(raw, host):
    assert raw(f"GET /healthz HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())[0] == 200


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "localhost.evil.example",
        "localhost:80@evil.example",
        "127.0.0.1.evil.example",
        "localhost evil",
        "",
        "localhost,evil.example",
        "[::1",
        "0.0.0.0",
    ],
)
def test_other_names_are_not(raw, host):
    status, _, _ = raw(f"GET /healthz HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
    assert status in {400, 421}


def test_a_request_without_a_host_and_with_two(raw):
    assert raw(b"GET /healthz HTTP/1.0\r\n\r\n")[0] == 421
    two = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n"
    assert raw(two)[0] in {400, 421}


def test_a_socket_needs_a_known_host_too(port, people):
    headers = people.token_headers("t", "read")
    url = "ws://evil.example/api/v1/live"
    with (
        socket.create_connection(("127.0.0.1", port)) as sock,
        pytest.raises(InvalidStatus) as refused,
        connect(url, sock=sock, additional_headers=headers, open_timeout=LIMIT_S),
    ):
        pass
    assert refused.value.response.status_code == 403


def test_more_names_can_be_allowed(tmp_path):
    config = ServiceConfig(database=tmp_path / "r.db", allowed_hosts=("Robots.example",))
    with serve_in_thread(create_app(config)) as port:
        connection = http.client.HTTPConnection("127.0.0.1", port)
        for host, status in (("robots.example:1", 200), ("robots.example.org", 421)):
            connection.request("GET", "/healthz", headers={"Host": host})
            answer = connection.getresponse()
            answer.read()
            assert answer.status == status


@pytest.mark.parametrize(
    ("host", "name"),
    [
        ("a:1", "a"),
        ("A", "a"),
        ("[::1]:2", "::1"),
        ("[::1]", "::1"),
        ("::1", "::1"),
        ("a:", "a:"),
        ("a:b", "a:b"),
        (":1", ""),
        ("", ""),
    ],
)
def test_the_name_in_a_host_header(host, name):
    assert parse_host_name(host) == name


# origins


def origin_status(client, headers, **origin):
    given = headers | {name.replace("_", "-"): value for name, value in origin.items()}
    return client.post("/api/v1/users", json={}, headers=given).status_code


def test_changes_come_from_our_own_pages_or_from_programs(client, port, admin):
    own = f"http://127.0.0.1:{port}"
    assert origin_status(client, admin) == 422
    assert origin_status(client, admin, Origin=own) == 422
    assert origin_status(client, admin, Origin=own, Sec_Fetch_Site="same-origin") == 422


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "http://127.0.0.1:1",
        "file://",
        "",
        "http://[",
        "http://127.0.0.1",
    ],
)
def test_changes_from_other_pages_are_refused(client, admin, origin):
    assert origin_status(client, admin, Origin=origin) == 403


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_browsers_that_tell_the_site_are_believed(client, admin, site):
    assert origin_status(client, admin, Sec_Fetch_Site=site) == 403


def test_a_login_from_another_page_is_refused(client):
    answer = client.post("/api/v1/login", json={}, headers={"Origin": "http://evil.example"})
    assert answer.status_code == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", None])
def test_a_socket_from_another_page_is_refused(port, people, origin):
    headers = people.session_headers("mary", "end_user")
    given = {
        "origin": origin,
        "additional_headers": headers,
        "proxy": None,
        "open_timeout": LIMIT_S,
    }
    url = f"ws://127.0.0.1:{port}/api/v1/live"
    with pytest.raises(InvalidStatus) as refused, connect(url, **given):
        pass
    assert refused.value.response.status_code == 403


# bodies


def put(path="/api/v1/users", sender=None):
    given = {"Host": "localhost", "Content-Type": "application/json", **(sender or {})}
    lines = "".join(f"{name}: {value}\r\n" for name, value in given.items())
    return f"POST {path} HTTP/1.1\r\n{lines}".encode()


@pytest.mark.parametrize("says", [True, False])
@pytest.mark.parametrize(
    ("path", "length", "status"),
    [
        ("/api/v1/login", MAX_STRANGER_BYTES, 422),
        ("/api/v1/login", MAX_STRANGER_BYTES + 1, 401),
        ("/api/v1/users", MAX_BODY_BYTES, 401),
    ],
)
def test_strangers_send_small_bodies(port, says, path, length, status):
    with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
        head = f"Content-Length: {length}\r\n" if says else "Transfer-Encoding: chunked\r\n"
        sock.sendall(put(path) + head.encode() + b"\r\n")
        if status == 422 or not says:
            body = b"0" * min(length, MAX_STRANGER_BYTES + 1)
            sock.sendall(body if says else chunk(body) + b"0\r\n\r\n")
        assert http_answer(sock)[0] == status


@pytest.fixture
def sender(people):
    """The headers of a program that is known."""
    return people.token_headers("program", "read")


@pytest.mark.parametrize(
    ("length", "status"), [(MAX_BODY_BYTES, 422), (MAX_BODY_BYTES + 1, 413), (1 << 40, 413)]
)
def test_a_body_is_bounded_by_what_it_says(raw, sender, length, status):
    head = put(sender=sender) + f"Content-Length: {length}\r\n\r\n".encode()
    answer = raw(head, b"0" * min(length, MAX_BODY_BYTES) if status == 422 else b"")
    assert answer[0] == status
    if status == 413:
        assert json.loads(answer[2])["error"] == "more than 1 MiB"


@pytest.mark.parametrize(("more", "status"), [(0, 422), (1, 413)])
def test_a_body_in_chunks_is_bounded_by_what_comes(raw, sender, more, status):
    chunks = [chunk(b"0" * (MAX_BODY_BYTES // 16))] * 16
    head = put(sender=sender) + b"Transfer-Encoding: chunked\r\n\r\n"
    tail = (chunk(b"0") if more else b"") + b"0\r\n\r\n"
    assert raw(head, *chunks, tail)[0] == status


def test_a_body_without_end_is_refused_while_it_comes(port, sender):
    with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
        sock.sendall(put(sender=sender) + b"Transfer-Encoding: chunked\r\n\r\n")
        sent = 0
        try:
            while sent < 64 * MAX_BODY_BYTES:
                sock.sendall(chunk(b"0" * 65536))
                sent += 65536
        except OSError:
            pass
        assert sent < 64 * MAX_BODY_BYTES


def test_a_graph_may_be_larger(client, raw, people):
    """Who sends too much whole may find the connection closed before the answer has come."""
    token = people.token_headers("dev", "developer")
    headers = token | {"Content-Type": "application/json"}
    path = "/api/v1/robots/car1/graph"
    spaces = b"{}" + b" " * (MAX_GRAPH_BYTES - 2)
    assert client.put(path, content=spaces, headers=headers).status_code not in {413, 500}
    lines = "".join(f"{name}: {value}\r\n" for name, value in headers.items())
    for method, where, length in (
        ("PUT", path, MAX_GRAPH_BYTES + 1),
        ("POST", path, MAX_GRAPH_BYTES),
        ("PUT", f"{path}/x", MAX_GRAPH_BYTES),
    ):
        head = f"{method} {where} HTTP/1.1\r\nHost: localhost\r\n{lines}"
        assert raw(f"{head}Content-Length: {length}\r\n\r\n".encode())[0] == 413


def test_a_body_that_does_not_come_is_not_waited_for(own_app):
    gate = next(
        each for each in own_app.user_middleware if each.cls is request_body.RequestBodyLimit
    )
    gate.kwargs["timeout_s"] = 0.2
    with (
        serve_in_thread(own_app) as port,
        socket.create_connection(("127.0.0.1", port), timeout=60) as sock,
    ):
        sock.sendall(put() + b"Content-Length: 10\r\n\r\n12345")
        assert http_answer(sock)[0] == 408


@pytest.mark.parametrize(
    "headers", [{"Content-Length": MAX_BODY_BYTES + 1}, {"Transfer-Encoding": "chunked"}]
)
@pytest.mark.parametrize(("role", "status"), [("", 401), ("end_user", 403), ("read", 403)])
def test_a_large_body_is_not_read_from_who_may_not_upload(port, people, headers, role, status):
    given = {"Host": "localhost", **(people.token_headers("t", role) if role else {}), **headers}
    head = "".join(f"{name}: {value}\r\n" for name, value in given.items())
    with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
        sock.sendall(b"PUT /api/v1/robots/x/graph HTTP/1.1\r\n" + head.encode() + b"\r\n")
        if "Transfer-Encoding" in headers:
            sock.sendall(chunk(b" " * (MAX_BODY_BYTES + 1)))
        assert http_answer(sock)[0] == status


def test_one_large_body_is_read_at_a_time(port, people):
    token = people.token_headers("dev", "developer")["Authorization"]
    head = (
        b"PUT /api/v1/robots/x/graph HTTP/1.1\r\nHost: localhost\r\n"
        b"Authorization: " + token.encode() + b"\r\n"
        b"Content-Length: " + str(MAX_GRAPH_BYTES).encode() + b"\r\n\r\n"
    )
    socks = [socket.create_connection(("127.0.0.1", port), timeout=60) for _ in range(2)]
    for sock in socks:
        sock.sendall(head)
    refused = wait_for(lambda: next(filter(_has_answer, socks), None))
    assert http_answer(refused)[0] == 503
    for sock in socks:
        sock.close()


def _has_answer(sock):
    sock.settimeout(0)
    try:
        return bool(sock.recv(1, socket.MSG_PEEK))
    except BlockingIOError:
        return False
    finally:
        sock.settimeout(60)


@pytest.mark.parametrize(
    ("document", "deep"),
    [
        (b"[" * MAX_DEPTH + b"]" * MAX_DEPTH, False),
        (b"[" * (MAX_DEPTH + 1) + b"]" * (MAX_DEPTH + 1), True),
        (b'{"a":' * (MAX_DEPTH + 1), True),
        (b'"' + b"[" * 100 + b'"', False),
        (b'"\\"' + b"[" * 100 + b'"', False),
        (b'"\\\\"' + b"[" * 100, True),
        (b'["' + b"]" * 50 + b'"' + b"[" * MAX_DEPTH, True),
        (b"[]" * 1000, False),
        (b'"' + b"[" * 100, False),
        (b'"\\', False),
        (b"", False),
        (b'"' + b"x" * 65535 + b"[" * 50 + b'"', False),
        (b'"' + b"x" * 65534 + b'"' + b"[" * 50, True),
        (b'"' + b"x" * 65534 + b'\\"' + b"[" * 50 + b'"', False),
        (b"[" * 30 + b" " * 65536 + b"[" * 11, True),
        (b"[" * 30 + b" " * 65536 + b"]" * 30 + b"[" * 40, False),
    ],
)
def test_nesting(document, deep):
    assert is_too_deep(document) is deep


def test_nesting_takes_linear_time():
    def search(size):
        for word in (b'"\\"",', b'\\"', b'"\\', b'"",', b"[],"):
            is_too_deep(b"[]" * (MAX_DEPTH + 1) + word * size)

    assert growth(search, 20_000, 200_000) < 30


def test_nesting_is_searched_in_slices_between_which_other_threads_go_on(monkeypatch):
    slices = []

    def counted(depths, initial):
        changes = list(depths)
        slices.append(len(changes))
        return accumulate(changes, initial=initial)

    monkeypatch.setattr(request_body, "accumulate", counted)
    assert not is_too_deep(b"[]" * (MAX_BODY_BYTES // 2))
    assert sum(slices) == MAX_BODY_BYTES
    assert max(slices) <= MAX_BODY_BYTES // 16


@pytest.mark.parametrize(
    "content",
    [
        b"[" * 100_000,
        b'{"a":' * 1000,
        b'{"name": "a\\u0000b"}',
        b'{"name": "a\0b"}',
        b"{",
        b"\xff",
        b"",
    ],
)
def test_bad_json_is_a_problem_and_nothing_else(client, admin, content):
    headers = admin | {"Content-Type": "application/json"}
    answer = client.post("/api/v1/users", content=content, headers=headers)
    assert answer.status_code in {400, 422}
    assert answer.json().keys() == {"error", "help"}


@pytest.mark.parametrize("path", ["/api/v1/events?text=%00", "/api/v1/robots/a%00b"])
def test_no_nul_in_addresses(client, admin, path):
    assert client.get(path, headers=admin).status_code == 400


# headers


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("GET", "/"),
        ("GET", "/healthz"),
        ("GET", "/nothing"),
        ("GET", "/api/v1/me"),
        ("POST", "/api/v1/login"),
        ("DELETE", "/healthz"),
        ("GET", "/openapi.json"),
        ("GET", "/console/x/../../etc/passwd"),
    ],
)
def test_every_answer_has_the_security_headers(client, method, path):
    answer = client.request(method, path)
    assert answer.headers.keys() >= HEADERS
    assert "default-src 'self'" in answer.headers["content-security-policy"]
    assert "unsafe" not in answer.headers["content-security-policy"]
    assert "server" not in answer.headers
    assert "strict-transport-security" not in answer.headers


def test_refusals_of_the_gates_have_them_too(raw):
    _, headers, body = raw(b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n")
    assert {name.lower() for name in headers} >= HEADERS
    assert json.loads(body).keys() == {"error", "help"}


def test_failures_have_them_and_tell_nothing(app, client, caplog):
    @app.get("/failing")
    def failing():
        raise ZeroDivisionError("inner secret")

    answer = client.get("/failing")
    assert answer.status_code == 500
    assert answer.headers.keys() >= HEADERS
    assert "inner" not in answer.text
    assert "ZeroDivisionError" in caplog.text


@pytest.mark.parametrize("path", ["/api/v1/me", "/metrics", "/healthz", "/readyz"])
def test_no_cache_keeps_what_the_api_says(client, path):
    assert client.get(path).headers["cache-control"] == "no-store"


def test_no_page_loads_anything_from_elsewhere(client):
    assert client.get("/docs").status_code == 404
    assert client.get("/redoc").status_code == 404
    assert client.get("/openapi.json").json()["info"]["title"] == "RTron security service"


# paths and heads


@pytest.mark.parametrize(
    "path",
    [
        "/../../../../etc/passwd",
        "/console/../../../etc/passwd",
        "/console/%2e%2e/%2e%2e/etc/passwd",
        "/console/x/..%2f..%2f..%2fetc/passwd",
        "//etc/passwd",
        "/api/v1/robots/../../../etc/passwd",
        "/api/v1/robots/%2e%2e%2f%2e%2e%2fetc%2fpasswd",
        "/api/v1/robots/..%5c..%5cetc",
        "/console/\\..\\..\\etc",
    ],
)
def test_no_path_leads_out(raw, people, path):
    token = people.token_headers("t", "admin")["Authorization"]
    head = f"GET {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: {token}\r\n\r\n"
    status, _, body = raw(head.encode())
    assert status in {400, 404, 422}
    assert b"root:" not in body


@pytest.mark.parametrize(
    "name", ["x%0d%0aSet-Cookie:%20a=b", "x%0aX-Evil:1", "%0d%0a%0d%0a<script>"]
)
def test_no_header_is_injected(client, people, name):
    headers = people.token_headers("t", "admin")
    for answer in (
        client.get(f"/api/v1/robots/{name}", headers=headers),
        client.delete(f"/api/v1/users/{name}", headers=headers),
        client.get(f"/console/{name}/{name}"),
    ):
        assert answer.status_code in {404, 422}
        assert "set-cookie" not in answer.headers
        assert "x-evil" not in answer.headers
        assert answer.headers["content-type"] == "application/json"


def test_a_long_head_is_refused(raw):
    head = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: " + b"x" * 2_000_000 + b"\r\n\r\n"
    try:
        assert raw(head)[0] == 400
    except ConnectionError:
        return  # it was closed before all was sent


def test_a_head_that_does_not_come_ends_the_connection(own_app, monkeypatch):
    monkeypatch.setattr("rtron.service.server.http_protocol._HEAD_TIMEOUT_S", 0.2)
    with serve_in_thread(own_app) as port:
        for said in (b"", b"GET / HTTP/1.1\r\nHost: loc"):
            with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
                sock.sendall(said)
                assert sock.recv(100) == b""
        with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
            request = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
            sock.sendall(request)
            assert http_answer(sock)[0] == 200
            sock.sendall(request[:20])
            assert sock.recv(100) == b""


@pytest.mark.parametrize("method", ["GET", "POST"])
def test_a_body_that_does_not_come_ends_the_connection(own_app, monkeypatch, method):
    """Also where it drips, and where the answer is there already."""
    monkeypatch.setattr("rtron.service.server.http_protocol._BODY_TIMEOUT_S", 0.5)
    monkeypatch.setattr("rtron.service.server.http._KEEP_ALIVE_S", 60)
    head = f"{method} /healthz HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n"
    with (
        serve_in_thread(own_app) as port,
        socket.create_connection(("127.0.0.1", port), timeout=60) as sock,
    ):
        sock.sendall(head.encode())
        sock.settimeout(0.05)
        wait_for(lambda: _has_ended(sock))


def _has_ended(sock):
    """Send one more byte of the body; tell whether the connection is over."""
    try:
        sock.sendall(b"x")
        return sock.recv(10_000) == b""
    except TimeoutError:
        return False
    except OSError:
        return True


def test_an_idle_connection_ends(own_app, monkeypatch):
    monkeypatch.setattr("rtron.service.server.http._KEEP_ALIVE_S", 0.2)
    with (
        serve_in_thread(own_app) as port,
        socket.create_connection(("127.0.0.1", port), timeout=60) as sock,
    ):
        sock.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert http_answer(sock)[0] == 200
        sock.settimeout(4)
        assert sock.recv(100) == b""


def test_no_address_has_all_connections(own_app, monkeypatch, people):
    monkeypatch.setattr("rtron.service.server.connection_limit.MAX_PER_TRUSTED_ADDRESS", 3)
    with serve_in_thread(own_app) as port:
        place = ("127.0.0.1", port)
        socks = [socket.create_connection(place, timeout=60) for _ in range(3)]
        with socket.create_connection(place, timeout=60) as sock:
            assert _refused(sock)
        socks.pop().close()
        wait_for(lambda: _is_served(place))
        for sock in socks:
            sock.close()


def _refused(sock):
    try:
        return sock.recv(1) == b""
    except ConnectionError:
        return True


def _is_served(place):
    with socket.create_connection(place, timeout=60) as sock:
        try:
            sock.sendall(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
            return http_answer(sock)[0] == 200
        except (ConnectionError, http.client.HTTPException):
            return False


def test_websockets_are_not_of_the_crowd(own_app, monkeypatch):
    """Many guards may be behind one address; their tokens bound them."""
    monkeypatch.setattr("rtron.service.server.connection_limit.MAX_PER_TRUSTED_ADDRESS", 1)
    headers = AccountFactory(own_app.state.service).token_headers("t", "read")
    with serve_in_thread(own_app) as port:
        options = {"additional_headers": headers, "proxy": None, "open_timeout": LIMIT_S}
        url = f"ws://127.0.0.1:{port}/api/v1/live"
        with connect(url, **options), connect(url, **options):
            wait_for(lambda: len(own_app.state.sockets) == 2, what="both sockets")


@pytest.mark.parametrize(
    ("address", "most"),
    [
        ("127.0.0.1", MAX_PER_TRUSTED_ADDRESS),
        ("::1", MAX_PER_TRUSTED_ADDRESS),
        ("::ffff:127.0.0.1", MAX_PER_TRUSTED_ADDRESS),
        ("10.1.2.3", MAX_PER_TRUSTED_ADDRESS),
        ("", MAX_PER_TRUSTED_ADDRESS),
        ("192.168.1.1", MOST_OF_ONE),
        ("2001:db8::1", MOST_OF_ONE),
    ],
)
def test_how_many_connections_an_address_may_have(address, most):
    crowd = ConnectionLimit(("10.0.0.0/8",))
    assert all(crowd.acquire(address) for _ in range(most))
    assert not crowd.acquire(address)
    crowd.release(address)
    assert crowd.acquire(address)
    assert crowd.acquire("203.0.113.1")


def test_neighbours_of_ipv6_are_one():
    crowd = ConnectionLimit(())
    assert all(crowd.acquire(f"2001:db8::{number:x}") for number in range(MOST_OF_ONE))
    assert not crowd.acquire("2001:db8::ffff")
    assert crowd.acquire("2001:db8:0:1::1")


def test_silent_connections_make_room_for_the_next_and_no_request_ends():
    crowd, ended = ConnectionLimit((), max_connections=3), []
    for number, name in enumerate(("oldest", "asking", "newest")):
        address = f"203.0.113.{number}"
        assert crowd.acquire(address)

        def abort(name=name, address=address):
            ended.append(name)
            crowd.release(address)

        crowd.add_waiting(name, abort)
    crowd.remove_waiting("asking")
    assert [crowd.acquire(f"198.51.100.{number}") for number in range(3)] == [True, True, False]
    assert ended == ["oldest", "newest"]
