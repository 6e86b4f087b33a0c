"""What a running ROS 1 node answers about its program and services (ROS wiki: TCPROS)."""

import os
import re
import socket
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import TypeVar
from urllib.parse import urlsplit

from rtron.errors import SourceError, WireError
from rtron.sources.launch.common.packages import package_name
from rtron.wire.ros1.ros_api import BusConnection, parse_bus_info, query_bus_info, query_process_id
from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, encode_header, frame_length
from rtron.wire.ros1.xmlrpc import split_uri

_PROC = Path("/proc")
_INSTALLED = re.compile(r".*/lib/([a-z][a-z0-9_]*)/([^/]+)")
_PYTHON = re.compile(r"python[0-9.]*")
_OPTIONS_WITHOUT_SCRIPT = (b"-m", b"-c", b"")
_TCP_LISTEN = "0A"
_LOCAL, _STATE, _INODE = 1, 3, 9


@dataclass(frozen=True, slots=True)
class NodeProgram:
    """What a node runs; empty where that is not known."""

    package: str = ""
    executable: str = ""


def find_program(uri: str, pid: int) -> NodeProgram:
    """Return what runs behind a node's address, if it is process `pid` of this machine.

    A node may claim any process id, so it counts only if that process listens on the address's
    port. The script of an interpreter is taken from its command line, which the process itself
    can rewrite: the answer tells people where to look, and is no ground for trust.
    """
    host, port = split_uri(uri)
    process = _PROC / str(pid)
    with suppress(OSError, ValueError):  # it has ended, or we may not look at it
        if _is_this_machine(host) and _is_listening(process, port):
            return _program_at(_program_file(process))
    return NodeProgram()


def _is_this_machine(host: str) -> bool:
    """Tell whether a host's address is one of ours: only then can it be bound."""
    family, kind, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
    with socket.socket(family, kind) as probe:
        try:
            probe.bind(address)
        except OSError:
            return False
    return True


def _is_listening(process: Path, port: int) -> bool:
    descriptors = (str(entry.readlink()) for entry in (process / "fd").iterdir())
    return not _listening_sockets(process, port).isdisjoint(descriptors)


def _listening_sockets(process: Path, port: int) -> set[str]:
    """Return the sockets that listen on a port, in the process's network."""
    sockets = set()
    for table in ("tcp", "tcp6"):
        with suppress(FileNotFoundError):  # a kernel without IPv6 has no tcp6
            for line in (process / "net" / table).read_text().splitlines()[1:]:
                fields = line.split()
                is_listening = fields[_STATE] == _TCP_LISTEN
                if is_listening and fields[_LOCAL].endswith(f":{port:04X}"):
                    sockets.add(f"socket:[{fields[_INODE]}]")
    return sockets


def _program_file(process: Path) -> Path:
    """Return the program's file, for Python that of its script."""
    program = (process / "exe").readlink()
    if not _PYTHON.fullmatch(program.name):
        return program
    arguments = (process / "cmdline").read_bytes().split(b"\0")
    script = _script(arguments[1:])
    return Path(os.path.normpath((process / "cwd").readlink() / os.fsdecode(script)))


def _script(arguments: list[bytes]) -> bytes:
    """Return the script among Python's arguments; ValueError if it runs a module or a text."""
    argument = next(
        argument
        for argument in (*arguments, b"-c")
        if argument in _OPTIONS_WITHOUT_SCRIPT or argument[:1] != b"-"
    )
    if argument in _OPTIONS_WITHOUT_SCRIPT:
        raise ValueError("no script")
    return argument


def _program_at(path: Path) -> NodeProgram:
    installed = _INSTALLED.fullmatch(str(path))
    if installed:
        return NodeProgram(*installed.groups())
    manifests = (folder for folder in path.parents if (folder / "package.xml").is_file())
    folder = next(manifests, None)
    return NodeProgram(package_name(folder) if folder else "", path.name)


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
