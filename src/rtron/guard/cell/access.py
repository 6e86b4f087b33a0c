"""How the guard gets into a cell: a Unix socket, at which a process inside hands out its sockets.

A socket belongs to the network namespace that it was made in (network_namespaces(7)), whoever uses
it. So the guard's own processes listen and connect inside a cell, and no message waits for another
process. Abstract Unix sockets do not lead out of a network namespace, paths do.
"""

import hashlib
import json
import os
import socket
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import SourceError
from rtron.guard.system.process_port import receive_files
from rtron.guard.system.unix_socket import peer_credentials, runtime_folder

TCP, DIAG, STATE = b"tcp", b"diag", b"state"
"""What a client sends that needs a socket, or the state."""
WATCH, GUARD, SUPERVISOR = b"watch", b"guard", b"supervisor"
"""What a client sends first that stays: as a guard, as the supervisor of one, or as neither.
"""
GUARD_BEAT, CARRIER_BEAT, FAREWELL = b".", b"c", b"e"
"""What is sent then: the guard or the supervisor is alive, the carrier between is (ROS 2), or the
carrier has seen its client end.
"""
SHARED_FOLDER = Path("/run/rtron")
"""Where a cell is found by a guard of another user."""
POOL_SIZE = 32
"""How many sockets a client that stays gets at once, so that its loop never waits for one."""
IDENTITY_SIZE = 16
CARRIER_SUFFIX = ".carrier"
"""What the path of the carriers' socket ends with."""
_TIMEOUT_S = 1.0
MAX_PACKET = 64
_MAX_STATE = 1 << 16


def socket_name(address: str, node: str) -> str:
    """Return the name of the socket of a node's cell, at a master or in a domain."""
    subject = f"{address.rstrip('/')}|{node}".encode()
    return f"rtron-cell-{hashlib.sha256(subject).hexdigest()[:32]}"


@dataclass(frozen=True, slots=True, kw_only=True)
class CellState:
    """What a cell tells of itself: the number of its network, and what it lacks.

    `gaps` are names of `Gap`. `guard_users` may enter, and `shared_users` are those of its node
    that others have, too, as they are outside.
    """

    namespace: int
    gaps: tuple[str, ...]
    guard_users: frozenset[int]
    shared_users: frozenset[int]


class CellAccess:
    """The way into the cell of a node, for processes of the guard."""

    def __init__(self, address: str, node: str) -> None:
        name = socket_name(address, node)
        self.node = node
        self._address = address
        self.paths = (runtime_folder() / name, SHARED_FOLDER / name)

    def watch(self, kind: bytes) -> tuple[socket.socket, bytes, list[socket.socket]]:
        """Return a connection, the cell's identity, and sockets that were made in it.

        The first socket is for `CellNetwork.open_diag`, the others are to listen with. SourceError
        if there is no cell.
        """
        connection = self._connect()
        try:
            connection.send(kind)
            identity, sockets = _receive_sockets(connection, POOL_SIZE)
        except OSError as error:
            connection.close()
            raise SourceError(f"the cell of {self.node} does not answer: {error}") from error
        if len(identity) != IDENTITY_SIZE or len(sockets) != POOL_SIZE:
            connection.close()
            raise SourceError(f"the cell of {self.node} does not answer as a cell does")
        return connection, identity, sockets

    def state(self) -> CellState:
        """Return what the cell tells of itself; SourceError if there is none."""
        with self._connect() as connection:
            try:
                connection.send(STATE)
                fields = json.loads(connection.recv(_MAX_STATE))
                return CellState(
                    namespace=int(fields["namespace"]),
                    gaps=tuple(fields["gaps"]),
                    guard_users=frozenset(fields["guard_users"]),
                    shared_users=frozenset(fields["shared_users"]),
                )
            except (OSError, ValueError, LookupError, TypeError) as error:
                raise SourceError(f"the cell of {self.node} tells no state: {error}") from error

    def open_socket(self) -> socket.socket:
        """Return a new socket that was made in the cell; SourceError if there is no cell."""
        with self._connect() as connection:
            try:
                connection.send(TCP)
                return _receive_sockets(connection, 1)[1][0]
            except (OSError, IndexError) as error:
                raise SourceError(f"the cell of {self.node} gives no socket: {error}") from error

    def connect_carrier(self) -> socket.socket:
        """Return a connection to a carrier in the cell (ROS 2); SourceError if there is no cell."""
        return self._connect(CARRIER_SUFFIX, socket.SOCK_STREAM)

    def _connect(self, suffix: str = "", kind: int = socket.SOCK_SEQPACKET) -> socket.socket:
        for path in self.paths:
            connection = socket.socket(socket.AF_UNIX, kind)
            connection.settimeout(_TIMEOUT_S)
            with suppress(OSError):
                connection.connect(f"{path}{suffix}")
                if peer_credentials(connection)[1] in (0, os.getuid()):
                    return connection
            connection.close()
        why = f"there is no cell of {self.node} at {self._address}"
        raise SourceError(why, help="start it: `rtron cell`")


def _receive_sockets(connection: socket.socket, most: int) -> tuple[bytes, list[socket.socket]]:
    identity, descriptors = receive_files(connection, MAX_PACKET, most)
    return identity, [socket.socket(fileno=descriptor) for descriptor in descriptors]


class CellNetwork:
    """The network in a cell; see `Network` of the wire. It has 127.0.0.1 and nothing else."""

    def __init__(self, access: CellAccess, pool: list[socket.socket]) -> None:
        """`pool` is what `CellAccess.watch` gives; when it is empty, others are fetched."""
        self._access = access
        self._diag, *self._pool = pool

    def connect(self, address: tuple[str, int], timeout: float) -> socket.socket:
        """Return a connection inside."""
        try:
            sock = self._access.open_socket()
        except SourceError as error:
            raise ConnectionRefusedError(str(error)) from error
        try:
            sock.settimeout(timeout)
            sock.connect(address)
        except BaseException:
            sock.close()
            raise
        return sock

    def listen(self, host: str, port: int, backlog: int) -> socket.socket:
        """Return a socket that listens inside."""
        sock = self._pool.pop() if self._pool else self._access.open_socket()
        sock.bind((host, port))
        sock.listen(backlog)
        return sock

    def open_diag(self) -> socket.socket | None:
        """Return a socket that asks the kernel about the cell's connections."""
        self._diag.settimeout(0)
        return self._diag

    def close(self) -> None:
        """Close what nobody has used."""
        while self._pool:
            self._pool.pop().close()
