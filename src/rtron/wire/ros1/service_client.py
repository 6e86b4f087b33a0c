"""Calling a service of ROS 1 (ROS wiki: TCPROS, Services), with one deadline for the whole call.

The service is a stranger: its answer is bounded, and whatever it sends is an error, never a crash.
"""

import socket
import time
from dataclasses import dataclass
from urllib.parse import urlsplit

from rtron.errors import SourceError, WireError
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, encode_header, frame_length
from rtron.wire.ros1.xmlrpc import RefusalError, ros_call

_MAX_REASON = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceCall:
    """A call: `caller` is the name of the node that makes it, `request` has its length in front."""

    master: str
    caller: str
    service: str
    type: str
    md5sum: str
    request: bytes
    max_response: int
    timeout: float
    """Seconds."""


def call_service(call: ServiceCall, network: Network = HOST_NETWORK) -> bytes:
    """Return the response to a call, its length in front.

    SourceError if nobody offers the service, it does not answer in time, or it says no; WireError
    if it breaks the protocol or its answer is too long.
    """
    deadline = time.monotonic() + call.timeout
    address = _address(call, network)
    try:
        with network.connect(address, call.timeout) as connection:
            connection.sendall(encode_header(_header(call)))
            _check_answer(call, _receive_frame(connection, MAX_HEADER, deadline))
            connection.sendall(call.request)
            return _receive_response(call, connection, deadline)
    except OSError as error:
        raise SourceError(f"{call.service} does not answer: {error}") from error


def _address(call: ServiceCall, network: Network) -> tuple[str, int]:
    params = (call.caller, call.service)
    try:
        uri = ros_call(call.master, "lookupService", *params, timeout=call.timeout, network=network)
    except RefusalError:
        raise SourceError(f"nobody offers {call.service}") from None
    try:
        where = urlsplit(str(uri))
        if where.scheme == "rosrpc" and where.hostname and where.port:
            return where.hostname, where.port
    except ValueError as error:
        raise WireError(f"{call.service} is at no address: {error}") from error
    raise WireError(f"{call.service} is at no address: {str(uri)[:80]!r}")


def _header(call: ServiceCall) -> dict[str, str]:
    return {
        "callerid": call.caller,
        "service": call.service,
        "type": call.type,
        "md5sum": call.md5sum,
    }


def _check_answer(call: ServiceCall, header: bytes) -> None:
    error = decode_header(header[LENGTH.size :]).get("error")
    if error:
        raise SourceError(f"{call.service} refuses: {error[:_MAX_REASON]}")


def _receive_response(call: ServiceCall, connection: socket.socket, deadline: float) -> bytes:
    is_success = _receive_exactly(connection, 1, deadline) != b"\0"
    frame = _receive_frame(connection, call.max_response, deadline)
    if is_success:
        return frame
    reason = frame[LENGTH.size :].decode(errors="replace")[:_MAX_REASON]
    raise SourceError(f"{call.service} has failed: {reason}")


def _receive_frame(connection: socket.socket, limit: int, deadline: float) -> bytes:
    prefix = _receive_exactly(connection, LENGTH.size, deadline)
    return prefix + _receive_exactly(connection, frame_length(prefix, limit), deadline)


def _receive_exactly(connection: socket.socket, size: int, deadline: float) -> bytes:
    data = bytearray()
    while len(data) < size:
        left = deadline - time.monotonic()
        if left <= 0:
            raise TimeoutError("timed out")
        connection.settimeout(left)
        part = connection.recv(min(size - len(data), 1 << 16))
        if not part:
            raise WireError("the service has closed the connection")
        data += part
    return bytes(data)
