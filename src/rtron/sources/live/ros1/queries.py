"""The type of a ROS 1 service, asked with a probe (ROS wiki: TCPROS)."""

import socket
import time
from urllib.parse import urlsplit

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, encode_header, frame_length

_CHUNK_BYTES = 1 << 16


def query_service_type(uri: str, service: str, caller: str, timeout: float) -> str:
    """Return the type that a service at a `rosrpc://host:port` address has.

    `timeout` (s) is for the whole. SourceError if nobody answers, WireError if the answer is none.
    """
    host, port = _address(uri)
    fields = {"probe": "1", "md5sum": "*", "callerid": caller, "service": service}
    deadline = time.monotonic() + timeout
    try:
        with socket.create_connection((host, port), timeout) as connection:
            connection.sendall(encode_header(fields))
            length = frame_length(_receive(connection, LENGTH.size, deadline), MAX_HEADER)
            header = decode_header(_receive(connection, length, deadline))
    except OSError as error:
        raise SourceError(f"service {service} at {uri}: {error}") from error
    if not header.get("type"):
        raise WireError(f"service {service} at {uri}: {header.get('error', 'it tells no type')}")
    return header["type"]


def _address(uri: str) -> tuple[str, int]:
    parts = urlsplit(uri)
    if parts.scheme != "rosrpc" or not parts.hostname or not parts.port:
        raise WireError(f"not a service's address: {uri!r}")
    return parts.hostname, parts.port


def _receive(connection: socket.socket, length: int, deadline: float) -> bytes:
    data = bytearray()
    while len(data) < length:
        remaining = deadline - time.monotonic()
        if remaining <= 0:
            raise TimeoutError("timed out")
        connection.settimeout(remaining)
        chunk = connection.recv(min(_CHUNK_BYTES, length - len(data)))
        if not chunk:
            raise WireError("the connection ended inside the header")
        data += chunk
    return bytes(data)
