"""The connection that is kept: whatever the other side sends, it is an answer or an error."""

import socket

import pytest
from faulty_nodes import garbage, saying, stranger
from harness import WaitLimit, free_port, wait_for

from rtron.errors import WireError
from rtron.guard.audit.ros1.master_queries import refuses_connections, resolve_uri
from rtron.guard.audit.ros1.poll_schedule import PollSchedule, PollTarget
from rtron.guard.audit.ros1.xmlrpc_poller import (
    ServerAddress,
    XmlRpcPoller,
    encode_call,
    response_body,
)
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND
from rtron.wire.ros1.xmlrpc import decode_call

MOST = 100
HEAD = b"HTTP/1.1 200 OK\r\nContent-Type: text/xml\r\nContent-length: 5\r\n\r\n"


def body(data, *, ended=False):
    return response_body(bytearray(data), MOST, closed=ended)


def test_the_question_is_a_call_that_keeps_its_connection():
    head, _, xml = encode_call("getBusInfo", "/me").partition(b"\r\n\r\n")
    assert decode_call(xml) == ("getBusInfo", ("/me",))
    assert f"Content-Length: {len(xml)}".encode() in head
    assert b"close" not in head


def test_an_answer_is_whole_at_its_last_byte_and_not_before():
    whole = HEAD + b"hello"
    for end in range(len(whole)):
        assert body(whole[:end]) is None
    assert body(whole) == b"hello"


def test_without_a_length_the_answer_lasts_as_long_as_the_connection():
    said = b"HTTP/1.0 200 OK\r\n\r\nhello"
    assert body(said) is None
    assert body(said, ended=True) == b"hello"


@pytest.mark.parametrize(
    ("said", "ended"),
    [
        (b"", True),
        (HEAD[:9], True),
        (HEAD, True),
        (HEAD + b"hell", True),
        (HEAD + b"hello!", False),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", False),
        (b"HTTP/2 200\r\n\r\n", False),
        (b"\x00" * 9000, False),
        (b"HTTP/1.1 200 OK\r\n" + b"a: b\r\n" * 2000, False),
        (HEAD.replace(b"5", b"101"), False),
        (HEAD.replace(b"5", b"999999999"), False),
        (b"HTTP/1.1 200 OK\r\n\r\n" + b"x" * 101, False),
    ],
)
def test_what_is_no_answer_is_refused(said, ended):
    with pytest.raises(WireError):
        body(said, ended=ended)


@pytest.mark.parametrize("length", [b"-1", b"0x5", b"5 5", b""])
def test_a_length_that_is_none_does_not_count(length):
    assert body(HEAD.replace(b"5", length) + b"hello") is None


def poll_target_at(loop, place):
    """Return a question in rounds of 20 ms, and what came of it."""
    came = []
    asked = PollTarget(
        poller=XmlRpcPoller(encode_call("x"), MOST), on_response=came.append, on_failure=came.append
    )
    asked.server = place
    rounds = PollSchedule(loop, SECOND // 50)
    rounds.add(asked)
    rounds.start()
    return came, rounds


def run_until(loop, condition):
    limit = WaitLimit()
    while not condition():
        limit.check()
        loop.step(0.01)


@pytest.fixture
def loop():
    made = EventLoop()
    yield made
    made.close()


def kept(connection):
    """Answer each question on one connection."""
    for word in (b"hello", b"hello", b"world", b"world"):
        connection.recv(1 << 12)
        connection.sendall(HEAD + word)


def test_the_same_answer_is_the_same_object(loop):
    with stranger(kept) as uri:
        came, rounds = poll_target_at(loop, resolve_uri(uri))
        run_until(loop, lambda: len(came) >= 4)
        rounds.close()
    assert came[:4] == [b"hello", b"hello", b"world", b"world"]
    assert came[0] is came[1]
    assert came[2] is came[3]


def test_a_server_that_closes_after_each_answer_is_asked_again(loop):
    with stranger(saying(b"hello")) as uri:
        came, rounds = poll_target_at(loop, resolve_uri(uri))
        run_until(loop, lambda: len(came) >= 3)
        rounds.close()
    assert came[:3] == [b"hello"] * 3


def slowly(connection):
    """Never come to an end."""
    connection.recv(1 << 12)
    connection.sendall(HEAD + b"hel")


@pytest.mark.parametrize("answer", [garbage, slowly, lambda connection: None])
def test_who_does_not_answer_well_fails_and_delays_nobody(loop, answer):
    with stranger(answer) as bad, stranger(kept) as good:
        failed, rounds = poll_target_at(loop, resolve_uri(bad))
        came, others = poll_target_at(loop, resolve_uri(good))
        run_until(loop, lambda: len(came) >= 4)
        run_until(loop, lambda: failed)
        rounds.close()
        others.close()
    assert all(isinstance(error, (OSError, WireError)) for error in failed)


def test_nobody_at_an_address_is_a_refusal(loop):
    port = free_port()
    place = ServerAddress("", (socket.AF_INET, ("127.0.0.1", port)))
    failed, rounds = poll_target_at(loop, place)
    run_until(loop, lambda: failed)
    rounds.close()
    assert isinstance(failed[0], ConnectionRefusedError)
    wait_for(lambda: refuses_connections(f"http://127.0.0.1:{port}/"), what="the refusal")


@pytest.mark.parametrize(
    "uri", ["", "x", "http://", f"http://{'x' * 70}.example:1/", "http://h:99999/"]
)
def test_an_address_that_is_none_leads_nowhere_and_refuses_nothing(uri):
    assert resolve_uri(uri) is None
    assert not refuses_connections(uri)
