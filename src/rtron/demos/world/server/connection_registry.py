"""The connections of a world: who is there, who is told, and who had to go."""

import logging
import selectors
import socket
import time
from collections.abc import Callable, Iterator
from functools import partial

from rtron.demos.world.server.connection import DeviceConnection
from rtron.demos.world.server.protocol import Head
from rtron.demos.world.server.requests import ClientRole
from rtron.errors import WireError

_LOG = logging.getLogger(__name__)
MAX_CONNECTIONS = 64
HELLO_LIMIT = 5.0
"""Wall s that a client has for its first frame."""


class ConnectionRegistry:
    """Keeps the selector in step with what each connection waits for."""

    def __init__(self, selector: selectors.BaseSelector) -> None:
        self._selector = selector
        self._connections: set[DeviceConnection] = set()

    def accept(self, listener: socket.socket) -> None:
        """Take a client in, if there is room."""
        try:
            peer, _ = listener.accept()
        except (BlockingIOError, ConnectionAbortedError):
            return
        if len(self._connections) >= MAX_CONNECTIONS:
            _LOG.error("a client was refused: %d are connected", MAX_CONNECTIONS)
            peer.close()
            return
        connection = DeviceConnection(peer, time.monotonic() + HELLO_LIMIT)
        self._connections.add(connection)
        self._selector.register(peer, selectors.EVENT_READ, connection)

    def with_role(self, role: ClientRole) -> list[DeviceConnection]:
        """Return the connections of a role."""
        return [connection for connection in self._connections if connection.role is role]

    def serve(self, connection: DeviceConnection, action: Callable[[], None]) -> None:
        """Do something with a connection; whoever breaks the protocol, or left, is let go."""
        if connection not in self._connections:  # it went while others were attended
            return
        try:
            action()
        except EOFError:
            self.drop(connection)
        except WireError as error:
            self.drop(connection, str(error))
        else:
            self._update_selector(connection)

    def send(self, role: ClientRole, head: Head) -> None:
        """Send a frame that must arrive to all of a role."""
        for connection in self.with_role(role):
            self.serve(connection, partial(connection.send, head))

    def send_state(self, role: ClientRole, frame: bytes) -> None:
        """Send a state to all of a role; who is behind gets the newest one alone."""
        for connection in self.with_role(role):
            self.serve(connection, partial(connection.send_state, frame))

    def drop_unidentified(self) -> None:
        """Let those go who did not say who they are."""
        now = time.monotonic()
        for connection in [each for each in self._connections if each.role is None]:
            if connection.hello_deadline < now:
                self.drop(connection, "did not say hello")

    def drop(self, connection: DeviceConnection, why: str = "") -> None:
        """Close a connection, once."""
        if connection not in self._connections:
            return
        if why:
            _LOG.error("the connection of a %s ends: %s", connection.role or "stranger", why)
        self._connections.remove(connection)
        self._selector.unregister(connection.socket)
        connection.close()

    def drop_all(self) -> None:
        """Close all connections."""
        for connection in list(self._connections):
            self.drop(connection)

    def __iter__(self) -> Iterator[DeviceConnection]:
        return iter(self._connections)

    def _update_selector(self, connection: DeviceConnection) -> None:
        events = selectors.EVENT_READ | (
            selectors.EVENT_WRITE if connection.has_pending_data else 0
        )
        if self._selector.get_key(connection.socket).events != events:
            self._selector.modify(connection.socket, events, connection)
