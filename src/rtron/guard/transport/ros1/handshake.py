"""Connecting to a publisher, in a worker thread, so that no dead node delays the loop."""

import socket
import time
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.guard.transport.ros1.tcp_server import set_socket_options
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, encode_header, frame_length
from rtron.wire.ros1.xmlrpc import call, ros_call

TIMEOUT_S = 3.0
"""How long a publisher may take for each step, seconds."""
_ADDRESS_LENGTH = 3


@dataclass(frozen=True, slots=True)
class TopicRequest:
    """The topic that one of our nodes requests, and the master that confirms names."""

    node: str
    topic: str
    type: str
    master: str
    network: Network = HOST_NETWORK


def connect(request: TopicRequest, uri: str) -> tuple[socket.socket, Peer]:
    """Return a connection that is ready to stream, and its peer.

    Raises SourceError or OSError if the publisher cannot be reached, WireError if it breaks the
    protocol or has another type.
    """
    host, port = _request_address(request, uri)
    try:
        sock = request.network.connect((host, port), TIMEOUT_S)
    except ValueError as error:
        raise WireError(f"{uri} names a host that is none: {host[:64]!r}") from error
    try:
        set_socket_options(sock)
        sock.sendall(encode_header(_connection_header(request)))
        peer = _peer_from_header(request, uri, _read_header(sock))
        sock.settimeout(0)
    except BaseException:
        sock.close()
        raise
    return sock, peer


def _request_address(request: TopicRequest, uri: str) -> tuple[str, int]:
    params = (request.node, request.topic, [["TCPROS"]])
    answer = ros_call(uri, "requestTopic", *params, timeout=TIMEOUT_S, network=request.network)
    if not isinstance(answer, list) or len(answer) != _ADDRESS_LENGTH or answer[0] != "TCPROS":
        raise WireError(f"{uri} offers no TCPROS address for {request.topic}")
    return str(answer[1]), _port(answer[2])


def _port(value: Any) -> int:  # noqa: ANN401 - any XML-RPC value
    if not isinstance(value, int) or not 0 < value < 1 << 16:
        raise WireError(f"not a port: {value!r}")
    return value


def _connection_header(request: TopicRequest) -> dict[str, str]:
    return {
        "callerid": request.node,
        "topic": request.topic,
        "type": request.type or "*",
        "md5sum": "*",
        "tcp_nodelay": "1",
    }


def _read_header(sock: socket.socket) -> dict[str, str]:
    deadline = time.monotonic() + TIMEOUT_S
    length = frame_length(_receive_exactly(sock, LENGTH.size, deadline), MAX_HEADER)
    return decode_header(_receive_exactly(sock, length, deadline))


def _receive_exactly(sock: socket.socket, size: int, deadline: float) -> bytes:
    data = bytearray()
    while len(data) < size:
        sock.settimeout(max(1e-3, deadline - time.monotonic()))
        part = sock.recv(size - len(data))
        if not part or time.monotonic() > deadline:
            raise WireError("the connection header did not arrive")
        data += part
    return bytes(data)


def _peer_from_header(request: TopicRequest, uri: str, fields: dict[str, str]) -> Peer:
    if "error" in fields:
        raise WireError(f"{uri} refuses: {fields['error']}")
    info = TypeInfo(
        fields.get("type", ""), fields.get("md5sum", ""), fields.get("message_definition", "")
    )
    if not info.type or info.md5sum in ("", "*"):
        raise WireError(f"{uri} does not say what it publishes on {request.topic}")
    if request.type and info.type != request.type:
        raise WireError(f"{uri} publishes {info.type} on {request.topic}, not {request.type}")
    node = fields.get("callerid", "")
    return Peer(node, info, fields.get("latching") == "1", _is_registered_at(request, node, uri))


def _is_registered_at(request: TopicRequest, node: str, uri: str) -> bool:
    """Ask the master whether the name that the peer gives is registered at its address.

    A master that does not answer has not said no: its SourceError goes up, and we try again.
    """
    params = (request.node, node)
    answer = call(request.master, "lookupNode", *params, timeout=TIMEOUT_S, network=request.network)
    return isinstance(answer, list) and answer[:1] == [1] and answer[-1] == uri
