"""Calls of services of ROS 1: what a stranger's service may answer, and what it may not."""

import socket
import struct
import threading
from contextlib import contextmanager
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.tcpros import ServiceCall, call_service, decode_header, encode_header

LIMIT_S = 20
HEADER = encode_header({"callerid": "/lamp", "md5sum": "x"})
ANSWER = b"\1" + struct.pack("<I", 3) + b"abc"


class Quiet(SimpleXMLRPCRequestHandler):
    def log_message(self, *_):
        """Say nothing."""


@contextmanager
def master(answer):
    """Serve a master that knows where every service is."""
    with SimpleXMLRPCServer(("127.0.0.1", 0), Quiet, allow_none=True) as server:
        server.register_function(lambda caller, name: answer, "lookupService")
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()
            thread.join(LIMIT_S)


@contextmanager
def service(*parts):
    """Serve one connection: a part each for the header and the request; give what came."""
    heard = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            connection, _ = server.accept()
            with connection:
                for part in parts:
                    heard.append(connection.recv(1 << 16))
                    connection.sendall(part)

        thread = threading.Thread(target=serve)
        thread.start()
        with master([1, "", f"rosrpc://127.0.0.1:{server.getsockname()[1]}"]) as uri:
            yield uri, heard
        thread.join(LIMIT_S)


def call(uri, timeout=LIMIT_S, limit=100):
    return call_service(
        ServiceCall(
            master=uri,
            caller="/bridge/web",
            service="/lamp",
            type="std_srvs/SetBool",
            md5sum="09fb03525b03e7ea1fd3992bafd87e16",
            request=b"\1\0\0\0\1",
            max_response=limit,
            timeout=timeout,
        )
    )


def test_a_call_as_tcpros_has_it():
    with service(HEADER, ANSWER) as (uri, heard):
        assert call(uri) == ANSWER[1:]
    assert decode_header(heard[0][4:]) == {
        "callerid": "/bridge/web",
        "service": "/lamp",
        "type": "std_srvs/SetBool",
        "md5sum": "09fb03525b03e7ea1fd3992bafd87e16",
    }
    assert heard[1] == b"\1\0\0\0\1"


@pytest.mark.parametrize(
    ("parts", "error", "why"),
    [
        ((encode_header({"error": "wrong md5"}),), SourceError, "/lamp refuses: wrong md5"),
        ((HEADER, b"\0\3\0\0\0bad"), SourceError, "/lamp has failed: bad"),
        ((HEADER, b"\1" + struct.pack("<I", 101)), WireError, "101 bytes"),
        ((HEADER, b"\1\xff\xff\xff\xff"), WireError, "4294967295 bytes"),
        ((HEADER, b"\1\3\0\0\0ab"), WireError, "has closed"),
        ((HEADER, b""), WireError, "has closed"),
        ((b"\xff\xff\xff\xff",), WireError, "4294967295 bytes"),
        ((b"\4\0\0\0abcd",), WireError, "ends inside a field"),
        ((b"HTTP/1.1 400\r\n\r\n",), WireError, "bytes"),
    ],
)
def test_what_is_no_answer_is_an_error(parts, error, why):
    with service(*parts) as (uri, _), pytest.raises(error, match=why):
        call(uri)


def test_a_service_that_never_answers_is_waited_for_once():
    with socket.create_server(("127.0.0.1", 0)) as silent:
        where = f"rosrpc://127.0.0.1:{silent.getsockname()[1]}"
        with master([1, "", where]) as uri, pytest.raises(SourceError, match="timed out"):
            call(uri, timeout=0.2)


@pytest.mark.parametrize(
    ("answer", "error", "why"),
    [
        ([-1, "unknown service", ""], SourceError, "nobody offers /lamp"),
        ([1, "", "http://127.0.0.1:1"], WireError, "at no address"),
        ([1, "", "rosrpc://:99999999"], WireError, "at no address"),
        ([1, "", 5], WireError, "at no address"),
        ([1, "", "rosrpc://127.0.0.1:1"], SourceError, "does not answer"),
        ("x", WireError, "not \\[code, message, value\\]"),
    ],
)
def test_what_is_no_address_is_an_error(answer, error, why):
    with master(answer) as uri, pytest.raises(error, match=why):
        call(uri)
