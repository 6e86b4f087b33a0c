"""The inner end of the way into a cell: a process in it that hands out sockets of its network."""

import json
import logging
import socket
from collections import Counter
from collections.abc import Callable, Iterable

from rtron.guard.cell.access import (
    CARRIER_BEAT,
    DIAG,
    FAREWELL,
    GUARD,
    MAX_PACKET,
    POOL_SIZE,
    STATE,
    SUPERVISOR,
    TCP,
    WATCH,
    CellState,
)
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.system.unix_socket import peer_credentials
from rtron.wire.ros1.network import NETLINK_SOCK_DIAG

log = logging.getLogger(__name__)

_PAUSE_S = 0.1


class AccessServer:
    """Hands out sockets of its own network to processes of the users that may have them.

    `beats` counts what guards and their supervisors send, by the one or the other, and
    `carrier_beats` what the carriers of guards do of their own. `has_left` tells that the last
    guard has ended, and not only its carrier.
    """

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        identity: bytes,
        users: Iterable[int],
        state: CellState,
        on_change: Callable[[], None] = lambda: None,
    ) -> None:
        """`sock` listens; `on_change` is called when one of those that beat has come or gone."""
        self._loop = loop
        self._identity = identity
        self._state = json.dumps(
            {
                "namespace": state.namespace,
                "gaps": state.gaps,
                "guard_users": sorted(state.guard_users),
                "shared_users": sorted(state.shared_users),
            }
        ).encode()
        self._users = frozenset(users)
        self._on_change = on_change
        self._roles: dict[socket.socket, bytes] = {}
        self.beats: Counter[bytes] = Counter()
        self.carrier_beats = 0
        self.has_left = False
        sock.settimeout(0)
        loop.watch(sock, lambda: self._accept(sock), lambda _: loop.suspend(sock, _PAUSE_S))

    def has(self, role: bytes) -> bool:
        """Tell whether a process of a role is connected."""
        return role in self._roles.values()

    def _accept(self, sock: socket.socket) -> None:
        client, _ = sock.accept()
        user = peer_credentials(client)[1]
        if user not in self._users:
            log.warning("user %d wants into the cell and is refused", user)
            client.close()
            return
        client.settimeout(0)
        self._loop.watch(client, lambda: self._serve(client), lambda _: self._forget(client))

    def _serve(self, client: socket.socket) -> None:
        request = client.recv(MAX_PACKET)
        if not request:
            self._forget(client)
        elif role := self._roles.get(client):
            self._count(role, request)
        elif request == STATE:
            client.send(self._state)
        elif request in (WATCH, GUARD, SUPERVISOR):
            kinds = (DIAG, *[TCP] * (POOL_SIZE - 1))
            self._send_sockets(client, [_create_socket(kind) for kind in kinds])
            if request != WATCH:
                self._roles[client] = request
                self.has_left = self.has_left and request != GUARD
                self._on_change()
        else:
            self._send_sockets(client, [_create_socket(TCP)])

    def _count(self, role: bytes, packet: bytes) -> None:
        if packet not in (CARRIER_BEAT, FAREWELL):
            self.beats[role] += 1
        elif role == GUARD and packet == CARRIER_BEAT:
            self.carrier_beats += 1
        elif role == GUARD:
            self.has_left = [*self._roles.values()].count(GUARD) == 1

    def _send_sockets(self, client: socket.socket, created: list[socket.socket]) -> None:
        try:
            socket.send_fds(client, [self._identity], [each.fileno() for each in created])
        finally:
            for each in created:
                each.close()

    def _forget(self, client: socket.socket) -> None:
        self._loop.forget(client)
        if self._roles.pop(client, None):
            self._on_change()


def _create_socket(kind: bytes) -> socket.socket:
    if kind == DIAG:
        return socket.socket(socket.AF_NETLINK, socket.SOCK_DGRAM, NETLINK_SOCK_DIAG)
    return socket.socket(socket.AF_INET, socket.SOCK_STREAM)
