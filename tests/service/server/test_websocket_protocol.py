"""What strangers do with WebSockets leaves no line in the log, however often they do it."""

import contextlib
import logging
import socket
import struct

import pytest

UPGRADE = (
    "GET {path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n{more}\r\n"
)
NOW = struct.pack("ii", 1, 0)
"""Linger for no time: the connection is reset (socket(7))."""

STRANGERS = {
    "a guard without a token": ("/link/v1", "127.0.0.1", ""),
    "a guard with a wrong token": ("/link/v1", "127.0.0.1", "Authorization: Bearer x\r\n"),
    "a console without a session": ("/api/v1/live", "127.0.0.1", "Authorization: Bearer x\r\n"),
    "another page": ("/api/v1/live", "127.0.0.1", "Origin: http://evil.example\r\n"),
    "another host": ("/api/v1/live", "evil.example", ""),
    "an address that is none": ("/nothing", "127.0.0.1", "Authorization: Bearer x\r\n"),
    "an address with NUL": ("/link/v1?%00", "127.0.0.1", "Authorization: Bearer x\r\n"),
}


@pytest.fixture(params=STRANGERS.values(), ids=STRANGERS.keys())
def upgrade(request):
    path, host, more = request.param
    return UPGRADE.format(path=path, host=host, more=more).encode()


def loud(caplog):
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


def test_who_is_refused_leaves_no_error_in_the_log(port, client, upgrade, caplog):
    with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
        sock.sendall(upgrade)
        status = int(sock.makefile("rb").readline().split()[1])
    assert status in (401, 403)
    assert client.get("/healthz").status_code == 200
    assert loud(caplog) == []


def test_nor_does_who_goes_before_the_answer(port, client, upgrade, caplog):
    for _ in range(10):
        with socket.create_connection(("127.0.0.1", port), timeout=60) as sock:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, NOW)
            sock.sendall(upgrade)
    with contextlib.closing(socket.create_connection(("127.0.0.1", port), timeout=60)) as sock:
        sock.sendall(upgrade)
        assert sock.makefile("rb").readline()
    assert client.get("/healthz").status_code == 200
    assert loud(caplog) == []
