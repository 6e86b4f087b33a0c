"""The two connection headers that TCPROS begins with, over a blocking socket."""

import socket

from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, frame_length

HANDSHAKE_S = 10.0


def read_header(sock: socket.socket) -> dict[str, str]:
    """Read one connection header."""
    length = frame_length(_receive_exactly(sock, LENGTH.size), MAX_HEADER)
    return decode_header(_receive_exactly(sock, length))


def _receive_exactly(sock: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        more = sock.recv(size - len(data))
        if not more:
            raise ConnectionError("closed during the handshake")
        data += more
    return data
