"""The connections of a world: who is there, who is told, and who had to go."""

import logging
import selectors
import socket
import time
from collections.abc import Callable, Iterator
from functools import partial

from rtron.demos.world.server.connection import Connection
from rtron.demos.world.server.protocol import Head
from rtron.demos.world.server.requests import Role
from rtron.errors import WireError

_LOG = logging.getLogger(__name__)
MAX_CONNECTIONS = 64
HELLO_LIMIT = 5.0
"""Wall s that a client has for its first frame."""


class Crowd:
    """Keeps the selector in step with what each connection waits for."""

    def __init__(self, selector: selectors.BaseSelector) -> None:
        self._selector = selector
        self._all: set[Connection] = set()

    def accept(self, listener: socket.socket) -> None:
        """Take a client in, if there is room."""
        try:
            peer, _ = listener.accept()
        except (BlockingIOError, ConnectionAbortedError):
            return
        if len(self._all) >= MAX_CONNECTIONS:
            _LOG.error("a client was refused: %d are connected", MAX_CONNECTIONS)
            peer.close()
            return
        connection = Connection(peer, time.monotonic() + HELLO_LIMIT)
        self._all.add(connection)
        self._selector.register(peer, selectors.EVENT_READ, connection)

    def of(self, role: Role) -> list[Connection]:
        """Return the connections of a role."""
        return [connection for connection in self._all if connection.role is role]

    def attend(self, connection: Connection, what: Callable[[], None]) -> None:
        """Do something with a connection; whoever breaks the protocol, or left, is let go."""
        if connection not in self._all:  # it went while others were attended
            return
        try:
            what()
        except EOFError:
            self.drop(connection)
        except WireError as error:
            self.drop(connection, str(error))
        else:
            self._watch(connection)

    def tell(self, role: Role, head: Head) -> None:
        """Send a frame that must arrive to all of a role."""
        for connection in self.of(role):
            self.attend(connection, partial(connection.must, head))

    def show(self, role: Role, frame: bytes) -> None:
        """Send a state to all of a role; who is behind gets the newest one alone."""
        for connection in self.of(role):
            self.attend(connection, partial(connection.state, frame))

    def drop_silent(self) -> None:
        """Let those go who did not say who they are."""
        now = time.monotonic()
        for connection in [each for each in self._all if each.role is None]:
            if connection.hello_until < now:
                self.drop(connection, "did not say hello")

    def drop(self, connection: Connection, why: str = "") -> None:
        """Close a connection, once."""
        if connection not in self._all:
            return
        if why:
            _LOG.error("the connection of a %s ends: %s", connection.role or "stranger", why)
        self._all.remove(connection)
        self._selector.unregister(connection.socket)
        connection.close()

    def drop_all(self) -> None:
        """Close all connections."""
        for connection in list(self._all):
            self.drop(connection)

    def __iter__(self) -> Iterator[Connection]:
        return iter(self._all)

    def _watch(self, connection: Connection) -> None:
        events = selectors.EVENT_READ | (selectors.EVENT_WRITE if connection.has_more else 0)
        if self._selector.get_key(connection.socket).events != events:
            self._selector.modify(connection.socket, events, connection)
