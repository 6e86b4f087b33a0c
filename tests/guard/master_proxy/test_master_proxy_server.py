"""The proxy among callers that break HTTP or XML-RPC; the master is a small real server."""

import contextlib
import datetime as dt
import socket
import threading
from xmlrpc.client import ServerProxy, dumps

import pytest
from harness import LIMIT_S, free_port, wait_for
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from masters import Master, http_post, raw, running_proxy, serving
from plans import grcn, plan_of

from example_budget import examples
from rtron.errors import RTronError, WireError
from rtron.guard.master_proxy import server, upstream
from rtron.guard.master_proxy.access_rules import denial_reason
from rtron.guard.master_proxy.server import MAX_CLIENTS, decode_calls
from rtron.vocabulary.topic_access import list_topic_access
from rtron.wire.ros1.xmlrpc import call, decode_call, ros_call

TOPICS = list_topic_access(plan_of(grcn("/cmd_vel", ["/nav"], ["/driver"])))
OUT, TYPE, URI = "/rtron/cmd_vel/out", "geometry_msgs/Twist", "http://localhost:9/"
NEVER_S = 3600.0
GET_PID = dumps(("/x",), "getPid").encode()


@pytest.fixture(scope="module")
def shared():
    """Return the proxy and the master behind it, the same for many tests."""
    master = Master()
    with serving(master) as private, running_proxy(TOPICS, private) as public:
        yield public, master


@pytest.fixture
def public(shared):
    uri, master = shared
    master.asked.clear()
    return uri


@pytest.fixture
def master(shared, public):
    return shared[1]


@pytest.mark.parametrize(
    "value",
    [
        0,
        -(2**31),
        2**31 - 1,
        1.5,
        float("inf"),
        True,
        "",
        " a\n\tb ",
        "ä<&>\"'\U0001f600",
        b"\x00\xff",
        dt.datetime(2026, 1, 2, 3, 4, 5),  # noqa: DTZ001 - XML-RPC has no zones
        [],
        {},
        {"a": [1, {"b": ""}], "": 2},
        ["x" * 200_000],
        ["x" * 5_000_000],
    ],
)
def test_a_value_arrives_as_it_was_sent(public, master, value):
    answer = ros_call(public, "setParam", "/x", "/key", value, timeout=LIMIT_S)
    assert answer[2] == value
    assert [method for method, _ in master.asked] == ["setParam"]


def test_what_is_forbidden_never_reaches_the_master(public, master):
    for method, params in (
        ("registerPublisher", ("/x", OUT, TYPE, URI)),
        ("unknown", ("/x",)),
        ("shutdown", ("/x", "")),
        ("system.listMethods", ()),
        ("system.multicall", ([{"methodName": "shutdown", "params": ["/x", ""]}],)),
        ("system.multicall", ([{"methodName": "system.multicall", "params": [[]]}],)),
    ):
        answer = call(public, method, *params, timeout=LIMIT_S)
        code, message, _ = answer[0][0] if method == "system.multicall" else answer
        assert (code, message[:23]) == (-1, "refused by rtron master")
    assert master.asked == []


def test_publishers_are_told_no_addresses_and_callers_the_public_one(public):
    answer = call(public, "registerPublisher", "/x", "/chatter", "*", URI, timeout=LIMIT_S)
    assert answer == [1, "registerPublisher", []]
    assert call(public, "getUri", "/x", timeout=LIMIT_S) == [1, "", "http://public:11311/"]


def test_a_bundle_of_what_is_allowed_goes_on_as_one(public, master):
    bundle = [{"methodName": "getParam", "params": ["/x", f"/{n}"]} for n in range(500)]
    answers = call(public, "system.multicall", bundle, timeout=LIMIT_S)
    assert [answer[0][2][1] for answer in answers] == [f"/{n}" for n in range(500)]
    assert master.asked[0] == ("system.multicall", (bundle,))


def test_a_bundle_with_a_forbidden_call_is_taken_apart(public, master):
    bundle = [{"methodName": "getParam", "params": ["/x", f"/{n}"]} for n in range(500)]
    bundle[250] = {"methodName": "unregisterPublisher", "params": ["/rtron_guard", "/a", URI]}
    answers = call(public, "system.multicall", bundle, timeout=LIMIT_S)
    assert [answer[0][0] for answer in answers].count(-1) == 1
    assert answers[250][0][0] == -1
    assert [params[1] for _, params in master.asked] == [f"/{n}" for n in range(500) if n != 250]


nodes = st.sampled_from(["/x", "/rtron_guard", "/rtron/grcn_cmd_vel", "x", "/x/"])
topics = st.sampled_from([OUT, "/cmd_vel", "/chatter", "/rtron/new", "chatter"])
bundled = st.one_of(
    st.tuples(st.sampled_from(["registerPublisher", "registerSubscriber"]), nodes, topics).map(
        lambda drawn: (drawn[0], [drawn[1], drawn[2], TYPE, URI])
    ),
    st.tuples(nodes, topics).map(lambda d: ("unregisterPublisher", [d[0], d[1], URI])),
    nodes.map(lambda node: ("lookupNode", ["/x", node])),
    st.sampled_from([("getPid", ["/x"]), ("shutdown", ["/x", ""]), ("system.multicall", [[]])]),
)


@settings(max_examples=examples(60), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(bundled, max_size=6))
def test_bundled_calls_fare_as_they_would_alone(public, master, calls):
    master.asked.clear()
    bundle = [{"methodName": method, "params": params} for method, params in calls]
    answers = call(public, "system.multicall", bundle, timeout=LIMIT_S)
    expected = [bool(denial_reason(TOPICS, *each)) for each in calls]
    assert [answer[0][1].startswith("refused") for answer in answers] == expected
    for method, params in master.asked:
        whole = method == "system.multicall"
        told = [(c["methodName"], c["params"]) for c in params[0]] if whole else [(method, params)]
        assert not any(denial_reason(TOPICS, *each) for each in told)


@pytest.mark.parametrize(
    "bundle",
    [
        7,
        [7],
        [{}],
        [{"methodName": "getPid"}],
        [{"methodName": 1, "params": []}],
        [{"methodName": "getPid", "params": ["/x"], "more": 1}],
        [{"methodName": "getPid", "params": {"0": "/x"}}],
        [{"methodName": "getPid", "params": ["/x"]}] * 20_000,
    ],
)
def test_a_bundle_that_is_none_is_closed(public, master, bundle):
    with pytest.raises(RTronError):
        call(public, "system.multicall", bundle, timeout=LIMIT_S)
    assert master.asked == []


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x00" * 99,
        b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
        b"\xff\r\n\r\n" * 9,
        http_post(b"<a>&bomb;"),
        http_post(b'<!DOCTYPE a [<!ENTITY b "c">]><methodCall/>'),
        http_post(b"<methodCall>" * 300),
        http_post(b"<methodCall><methodName>getPid</methodName></methodCall"),
        http_post(dumps((2**31 - 1,), "getPid").replace(str(2**31 - 1), "9" * 30).encode()),
        http_post(GET_PID).replace(b"Content-Length", b"Content-Lengt"),
        http_post(GET_PID, "Content-Length: 3\r\n"),
        http_post(GET_PID, "Transfer-Encoding: chunked\r\n"),
        b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 99999999999\r\n\r\n" + b"a" * (1 << 18),
        b"POST / HTTP/1.1\r\n" + b"x: y\r\n" * 9999,
    ],
)
def test_what_is_no_call_is_closed_and_harms_nobody(public, master, data):
    with contextlib.suppress(OSError):
        raw(public, data)
    assert master.asked == []
    assert ros_call(public, "getPid", "/x", timeout=LIMIT_S) == ["/x"]


def test_a_body_over_the_bound_is_closed(public, master):
    head = b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 20000000\r\n\r\n"
    with pytest.raises(OSError):  # noqa: PT012 - wherever it notices
        raw(public, head + b"a" * 17_000_000)
        raise ConnectionError("closed without a word")
    assert ros_call(public, "getPid", "/x", timeout=LIMIT_S) == ["/x"]


def test_two_calls_at_once_on_one_connection_are_answered_in_order(public):
    said = raw(
        public,
        http_post(GET_PID) + http_post(dumps(("/y",), "getPid").encode(), "Connection: close\r\n"),
        shut=False,
    )
    assert said.count(b"200") == 2
    assert 0 < said.index(b"<string>/x<") < said.index(b"<string>/y<")


def test_a_connection_is_kept_for_the_next_call(public):
    with ServerProxy(public) as kept:
        for number in range(50):
            assert kept.getParam("/x", f"/{number}")[2] == ["/x", f"/{number}"]


@settings(max_examples=examples(300), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_whatever_arrives_is_closed_or_answered(public, master, data):
    whole = http_post(GET_PID)
    start = data.draw(st.integers(0, len(whole)))
    end = data.draw(st.integers(start, min(len(whole), start + 9)))
    put = data.draw(st.binary(max_size=9))
    with contextlib.suppress(OSError):
        raw(public, whole[:start] + put + whole[end:])
    assert {method for method, _ in master.asked} <= {"getPid"}


@settings(deadline=None)
@given(st.binary(max_size=60) | st.text(max_size=60).map(str.encode))
def test_a_request_is_understood_or_refused(body):
    with contextlib.suppress(WireError):
        decode_calls(body)
    params = b"<params><param><value>%b</value></param></params>"
    wrapped = b"<methodCall><methodName>m</methodName>%b</methodCall>" % params
    with contextlib.suppress(WireError):
        method, params = decode_call(wrapped % body)
        calls = decode_calls(wrapped % body)
        assert decode_call(calls[0].body) == (method, params)


def test_callers_that_say_nothing_delay_nobody(public):
    with contextlib.ExitStack() as silent:
        port = int(public.rstrip("/").rpartition(":")[2])
        for number in range(200):
            sock = silent.enter_context(socket.create_connection(("127.0.0.1", port), LIMIT_S))
            sock.sendall(http_post(GET_PID)[: number % 60])
        assert ros_call(public, "getPid", "/x", timeout=LIMIT_S) == ["/x"]


def test_of_too_many_callers_the_one_silent_longest_is_let_go(public):
    port = int(public.rstrip("/").rpartition(":")[2])
    with contextlib.ExitStack() as silent:
        first = silent.enter_context(socket.create_connection(("127.0.0.1", port), LIMIT_S))
        for _ in range(MAX_CLIENTS):
            silent.enter_context(socket.create_connection(("127.0.0.1", port), LIMIT_S))
        assert first.recv(1) == b""
        assert ros_call(public, "getPid", "/x", timeout=LIMIT_S) == ["/x"]


@contextlib.contextmanager
def accept_call(listening, method):
    """Take a call of a method and leave it without an answer until the end of the block."""
    listening.settimeout(LIMIT_S)
    with contextlib.ExitStack() as connections:
        request = b""
        while method not in request:
            connection = connections.enter_context(listening.accept()[0])
            connection.settimeout(LIMIT_S)
            request = connection.recv(1 << 16)
        yield


def test_a_master_that_hangs_delays_only_who_asks_it(monkeypatch):
    monkeypatch.setattr(upstream, "TIMEOUT_S", NEVER_S)
    answers = []
    with socket.create_server(("127.0.0.1", 0)) as hanging:
        private = f"http://127.0.0.1:{hanging.getsockname()[1]}/"
        with running_proxy(TOPICS, private) as public:
            asks = threading.Thread(
                target=lambda: answers.append(call(public, "getPid", "/x", timeout=LIMIT_S))
            )
            asks.start()
            with accept_call(hanging, b"getPid"):
                for _ in range(20):
                    assert call(public, "lookupNode", "/x", "/driver", timeout=LIMIT_S)[0] == -1
                assert asks.is_alive()
            asks.join()
    assert answers == [[-1, "the master behind the proxy does not answer", -1]]


def test_who_asks_a_master_that_hangs_is_answered_in_the_end(monkeypatch):
    monkeypatch.setattr(upstream, "TIMEOUT_S", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as hanging:
        private = f"http://127.0.0.1:{hanging.getsockname()[1]}/"
        with running_proxy(TOPICS, private) as public:
            answer = call(public, "getPid", "/x", timeout=LIMIT_S)
    assert answer == [-1, "the master behind the proxy does not answer", -1]


@pytest.mark.parametrize(
    "said",
    [b"", b"HTTP/1.1 500 no\r\nContent-Length: 0\r\n\r\n", bytes(range(256)), b"HTTP/1.1 200"],
)
def test_a_master_that_says_no_sense_is_an_error(said):
    with socket.create_server(("127.0.0.1", 0)) as broken:

        def answer():
            connection, _ = broken.accept()
            with connection:
                connection.recv(1 << 16)
                connection.sendall(said)

        thread = threading.Thread(target=answer)
        thread.start()
        with running_proxy((), f"http://127.0.0.1:{broken.getsockname()[1]}/") as public:
            assert call(public, "getPid", "/x", timeout=LIMIT_S)[0] == -1
        thread.join()


@pytest.mark.parametrize(("most", "answered"), [(0, b""), (1, b"H")])
def test_too_many_long_calls_at_once_are_closed_and_short_ones_answered(
    public, monkeypatch, most, answered
):
    monkeypatch.setattr(server, "_MOST_LONG", most)
    port = int(public.rstrip("/").rpartition(":")[2])
    long = http_post(dumps(("/x", "/long", ["z"] * 20_000), "setParam").encode())
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", port), LIMIT_S) as sock:
            sock.sendall(long)
            assert sock.recv(1) == answered
    assert ros_call(public, "getPid", "/x", timeout=LIMIT_S) == ["/x"]


def test_long_calls_share_a_budget_and_short_ones_need_none(monkeypatch):
    monkeypatch.setattr(server, "MAX_REQUEST_BYTES", 1 << 20)
    head = b"POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Length: 9000000\r\n\r\n"
    with contextlib.ExitStack() as stack:
        public = stack.enter_context(running_proxy(TOPICS, stack.enter_context(serving(Master()))))
        port = int(public.rstrip("/").rpartition(":")[2])

        def begun(size):
            sock = stack.enter_context(socket.create_connection(("127.0.0.1", port), LIMIT_S))
            sock.sendall(head + b"x" * size)
            return sock

        begun(1 << 20)
        wait_for(lambda: is_closed(begun(200_000)), what="the end of a caller that asks for more")
        assert ros_call(public, "setParam", "/x", "/key", "y" * 50_000, timeout=LIMIT_S)
        assert not is_closed(begun(1 << 16))


def test_a_call_that_was_answered_or_given_up_leaves_its_budget_to_others(monkeypatch):
    monkeypatch.setattr(server, "MAX_REQUEST_BYTES", 1 << 20)
    with serving(Master()) as private, running_proxy(TOPICS, private) as public:
        port = int(public.rstrip("/").rpartition(":")[2])
        for _ in range(5):
            wait_for(lambda: is_set(public), what="room for a long call")
            with socket.create_connection(("127.0.0.1", port), LIMIT_S) as sock:
                sock.sendall(http_post(b"x" * 900_000)[:-1])


def is_set(public):
    """Tell whether there is room for a long call; who has left may not have been noticed yet."""
    try:
        return ros_call(public, "setParam", "/x", "/key", "y" * 900_000, timeout=LIMIT_S)
    except RTronError:
        return None


def is_closed(sock):
    """Tell whether the other side has closed; the connection of one that goes on is silent."""
    sock.settimeout(0.2)
    try:
        return sock.recv(1) == b""
    except TimeoutError:
        return False
    except ConnectionError:
        return True


def test_nothing_is_asked_for_a_caller_that_has_left(public, master):
    port = int(public.rstrip("/").rpartition(":")[2])
    long = ["z"] * 100_000
    with socket.create_connection(("127.0.0.1", port)) as sock:
        sock.sendall(http_post(dumps(("/x", "/left", long), "setParam").encode()))
    for number in range(2):  # each is read after what was sent before it
        ros_call(public, "setParam", "/x", f"/{number}", long, timeout=60)
    assert [params[1] for _, params in master.asked] == ["/0", "/1"]


def test_a_dead_master_is_an_error():
    with running_proxy((), f"http://127.0.0.1:{free_port()}/") as public:
        assert call(public, "getPid", "/x", timeout=LIMIT_S)[0] == -1
        assert call(public, "getPid", "/x", timeout=LIMIT_S)[0] == -1
