"""The type of a ROS 1 service, asked with a probe (ROS wiki: TCPROS)."""

import socket
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from queue import Empty, SimpleQueue
from typing import TypeVar
from urllib.parse import urlsplit

from rtron.errors import SourceError, WireError
from rtron.sources.live.ros1.process import NodeProgram, find_program
from rtron.wire.ros1.ros_api import BusConnection, parse_bus_info, query_bus_info, query_process_id
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


_MAX_ERROR_LENGTH = 300


@dataclass(frozen=True, slots=True)
class NodeReplies:
    """A node's address, who sends it messages, what it runs, and why not all of it is known."""

    uri: str = ""
    incoming: tuple[BusConnection, ...] = ()
    program: NodeProgram = field(default_factory=NodeProgram)
    error: str = ""


def query_node(uri: str, caller: str, timeout: float) -> NodeReplies:
    """Ask a node; each of two calls may take `timeout` seconds. Does not raise."""
    replies = NodeReplies(uri)
    try:
        connections = parse_bus_info(query_bus_info(uri, caller, timeout), connected_only=True)
        replies = replace(replies, incoming=connections)
        return replace(replies, program=find_program(uri, query_process_id(uri, caller, timeout)))
    except Exception as error:  # noqa: BLE001 - a stranger's answer must not end the scan
        return replace(replies, error=str(error)[:_MAX_ERROR_LENGTH])


_T = TypeVar("_T")
_MAX_THREADS = 64


def run_with_deadline(jobs: Mapping[str, Callable[[], _T]], limit: float) -> dict[str, _T]:
    """Return the results of the jobs that end within `limit` seconds; jobs must not raise.

    A job that hangs (a name server that never answers cannot be timed out) keeps a daemon thread
    and nobody else.
    """
    pending: SimpleQueue[str] = SimpleQueue()
    done: SimpleQueue[tuple[str, _T]] = SimpleQueue()
    for name in jobs:
        pending.put(name)
    deadline = time.monotonic() + limit

    def work() -> None:
        while time.monotonic() < deadline:
            try:
                name = pending.get_nowait()
            except Empty:
                return
            done.put((name, jobs[name]()))

    for _ in range(min(_MAX_THREADS, len(jobs))):
        threading.Thread(target=work, daemon=True).start()
    return _collect(done, len(jobs), deadline)


def _collect(done: SimpleQueue[tuple[str, _T]], expected: int, deadline: float) -> dict[str, _T]:
    results: dict[str, _T] = {}
    while len(results) < expected:
        try:
            name, result = done.get(timeout=max(0.0, deadline - time.monotonic()))
        except Empty:
            break
        results[name] = result
    return results
