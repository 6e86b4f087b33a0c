"""XML-RPC documents, and a call over a real socket to a peer that may be hostile."""

import math
import socket
import threading
from contextlib import contextmanager
from xmlrpc.client import dumps

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.xmlrpc import (
    MAX_BODY,
    call,
    decode_call,
    decode_response,
    encode_response,
    ros_call,
    split_uri,
)

texts = st.text(st.characters(exclude_categories=["Cs", "Cc"]))
leaves = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**31), 2**31 - 1),
    st.floats(allow_nan=False),
    texts,
    st.binary(),
)
values = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=10,
)
BOMB = b"""<?xml version="1.0"?><!DOCTYPE b [<!ENTITY a "aaaaaaaaaa">
<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>
<methodResponse><params><param><value>&c;</value></param></params></methodResponse>"""
EXTERNAL = b"""<?xml version="1.0"?><!DOCTYPE b [<!ENTITY a SYSTEM "file:///etc/hostname">]>
<methodResponse><params><param><value>&a;</value></param></params></methodResponse>"""


def response(value):
    text = f"<methodResponse><params><param>{value}</param></params></methodResponse>"
    return text.encode()


def nested(levels):
    start = "<value><array><data>"
    return response(start * levels + "</data></array></value>" * levels)


@given(values)
def test_an_answer_survives_the_way(value):
    assert decode_response(encode_response(value)) == value


@given(st.lists(values, max_size=4))
def test_a_call_survives_the_way(params):
    document = dumps(tuple(params), "publisherUpdate", allow_none=True).encode()
    assert decode_call(document) == ("publisherUpdate", tuple(params))


def test_not_a_number_survives_the_way():
    assert math.isnan(decode_response(encode_response(math.nan)))


@pytest.mark.parametrize("document", [BOMB, EXTERNAL], ids=["bomb", "external"])
@pytest.mark.parametrize("decode", [decode_call, decode_response])
def test_entities_are_refused(decode, document):
    with pytest.raises(WireError, match="a DTD is not accepted"):
        decode(document)


def test_nesting_is_bounded():
    assert decode_response(nested(40)) == eval("[" * 40 + "]" * 40)
    with pytest.raises(WireError, match="nested deeper"):
        decode_response(nested(50_000))


def test_a_nested_fault_is_a_wire_error():
    deep = nested(50_000).replace(b"params>", b"fault>").replace(b"param>", b"")
    with pytest.raises(WireError):
        decode_response(deep)


def test_a_fault_is_a_wire_error_with_its_words_shortened():
    members = "<member><name>faultCode</name><value><int>1</int></value></member>"
    members += f"<member><name>faultString</name><value>no{'!' * 9000}</value></member>"
    fault = f"<methodResponse><fault><value><struct>{members}</struct></value></fault>"
    with pytest.raises(WireError, match="XML-RPC fault: no!") as caught:
        decode_response(f"{fault}</methodResponse>".encode())
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize(
    "document",
    [
        b"",
        b"\x00",
        b"<methodResponse/>",
        b"<methodCall></methodCall>",
        response("<value><int>x</int></value>"),
        response("<value><int>" + "9" * 5000 + "</int></value>"),
        response("<value><struct><member><value/></member></struct></value>"),
        response("<value/>") * 2,
        response("<value/>")[:-1],
        b" " * (MAX_BODY + 1),
    ],
)
def test_a_malformed_document_is_refused(document):
    for decode in (decode_call, decode_response):
        with pytest.raises(WireError):
            decode(document)


@pytest.mark.parametrize(
    "uri", ["http://robot:11311", "http://robot:11311/", "http://robot:11311/x"]
)
def test_an_address_is_split(uri):
    assert split_uri(uri) == ("robot", 11311)


@pytest.mark.parametrize(
    "uri",
    [
        "",
        "robot",
        "http://robot",
        "http://robot:0",
        "http://robot:65536",
        "https://robot:1",
        "http://[:1",
        "http://:1",
        "rosrpc://robot:1",
        None,
        7,
        [],
        b"http://robot:1",
    ],
)
def test_what_is_no_address_is_refused(uri):
    with pytest.raises(WireError, match="not an XML-RPC address"):
        split_uri(uri)


def read_request(connection):
    """Read until the request's body ends."""
    got = b""
    while not got.endswith(b"</methodCall>\n"):
        got += connection.recv(1 << 16)
    return got


@contextmanager
def peer(answer, *, keep_open=False):
    """Yield the address of a peer that reads one request, sends these bytes and hangs up."""
    done = threading.Event()
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            connection, _ = server.accept()
            with connection:
                read_request(connection)
                connection.sendall(answer)
                if keep_open:
                    done.wait(60)

        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.getsockname()[1]}/"
        finally:
            done.set()
            thread.join(60)


def http(body, status="200 OK"):
    return f"HTTP/1.1 {status}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body


def test_a_call_returns_the_value_of_a_good_answer():
    with peer(http(encode_response([1, "ok", ["a"]]))) as uri:
        assert ros_call(uri, "getPid", "/rtron", timeout=60) == ["a"]


def test_the_last_byte_of_the_body_is_enough():
    with peer(http(encode_response("x")), keep_open=True) as uri:
        assert call(uri, "getPid", timeout=60) == "x"


@pytest.mark.parametrize("status", [0, -1])
def test_a_refusal_is_a_source_error(status):
    with (
        peer(http(encode_response([status, "no", 0]))) as uri,
        pytest.raises(SourceError, match=r"getPid at .*: no"),
    ):
        ros_call(uri, "getPid", timeout=60)


@pytest.mark.parametrize("value", [7, [], [1, "ok"], [1, "ok", 0, 0], {"a": 1}])
def test_an_answer_that_is_no_triple_is_a_wire_error(value):
    with (
        peer(http(encode_response(value))) as uri,
        pytest.raises(WireError, match=r"not \[code, message, value\]"),
    ):
        ros_call(uri, "getPid", timeout=60)


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"nonsense\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nContent-Length: 9\r\n\r\nshort",
        b"HTTP/1.1 200 OK\r\nContent-Length: -1\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
        b"HTTP/1.1 200 OK\r\nX: " + b"x" * 100_000,
        http(b"<html/>", "404 Not Found"),
        http(BOMB),
    ],
)
def test_whatever_is_not_the_protocol_is_a_wire_error(answer):
    with peer(answer) as uri, pytest.raises((WireError, SourceError)):
        call(uri, "getPid", timeout=60)


def test_an_endless_answer_is_cut_off():
    head = b"HTTP/1.1 200 OK\r\nContent-Length: 99999999999\r\n\r\n"
    with (
        peer(head + b" " * (MAX_BODY + 1), keep_open=True) as uri,
        pytest.raises(WireError, match="longer than"),
    ):
        call(uri, "getPid", timeout=60)


def test_a_peer_that_says_nothing_is_a_source_error_in_time():
    with peer(b"", keep_open=True) as uri, pytest.raises(SourceError, match="timed out"):
        call(uri, "getPid", timeout=0.2)


def test_nobody_there_is_a_source_error():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(SourceError, match="getPid at"):
        call(f"http://127.0.0.1:{port}", "getPid", timeout=60)


@pytest.mark.parametrize("host", ["..", "a" * 70, "no\udc80such"])
def test_a_host_that_cannot_exist_is_a_source_error(host):
    with pytest.raises(SourceError):
        call(f"http://{host}:80", "getPid", timeout=60)
