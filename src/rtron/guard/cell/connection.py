"""One cell as a process of the guard sees it: there or not, and what is done whenever it is."""

import logging
import socket
from collections.abc import Callable
from contextlib import suppress
from threading import Thread
from typing import TYPE_CHECKING, Generic, TypeVar

from rtron.errors import SourceError, WireError
from rtron.guard.cell.access import GUARD_BEAT, WATCH, CellAccess
from rtron.guard.core.event_loop import EventLoop

if TYPE_CHECKING:
    from rtron.guard.cell.ros2.carried_side import CarriedSide
    from rtron.guard.transport.ros1.middleware import Ros1Transport

log = logging.getLogger(__name__)

_RETRY_S = 0.2
_TELL_AFTER = 25
"""After how many looks it is told that there is no cell, 5 s."""
BEAT_S = 0.02
"""How often a guard beats, seconds."""


Side = TypeVar("Side", bound="Ros1Transport | CarriedSide")
"""A transport inside a cell."""


class CellConnection(Generic[Side]):
    """Has a transport inside a cell whenever there is one, with all that was asked of it.

    A cell comes and goes with its node; each has a new transport. A process with the role of a
    guard or a supervisor beats, so that the stopper in the cell knows that somebody guards. Where
    only the stopper is started again, the transport and its connections stay. Nothing here makes
    the loop wait: the cell is looked for in a thread.
    """

    def __init__(
        self,
        loop: EventLoop,
        access: CellAccess,
        open_side: Callable[[list[socket.socket]], Side],
        *,
        role: bytes,
    ) -> None:
        """`open_side` makes the transport, with sockets that were made inside."""
        self.access = access
        self.side: Side | None = None
        """The transport in the last cell, None before there was one."""
        self._loop = loop
        self._open_side = open_side
        self._role = role
        self._steps: list[Callable[[Side], object]] = []
        self._connection: socket.socket | None = None
        self._identity = b""
        self._is_closed = False
        self._missed = 0
        loop.post(self._look)

    def apply(self, step: Callable[[Side], object]) -> None:
        """Do something on the transport now, and on each later one."""
        self._steps.append(step)
        if self.side:
            step(self.side)

    def renew(self) -> None:
        """Make another transport: this one does not reach the cell any more."""
        self._identity = b""
        if self._connection and not self._is_closed:
            self._disconnect()
            self._loop.call_later(_RETRY_S, self._look)

    def close(self) -> None:
        """Leave the cell, and look for none any more."""
        self._is_closed = True
        side, self.side = self.side, None
        if side:
            side.close()
        self._disconnect()

    def _look(self) -> None:
        if not self._is_closed:
            Thread(target=self._find, name=f"cell of {self.access.node}", daemon=True).start()

    def _find(self) -> None:
        """Look for the cell, in a thread."""
        try:
            found = self.access.watch(self._role)
        except SourceError as error:
            why = str(error)
            self._loop.post(lambda: self._miss(why))
            return
        self._loop.post(lambda: self._enter(*found))

    def _miss(self, why: str) -> None:
        self._missed += 1
        if self._missed == _TELL_AFTER:
            log.warning("%s: nothing reaches it", why)
        self._loop.call_later(_RETRY_S, self._look)

    def _enter(self, connection: socket.socket, identity: bytes, pool: list[socket.socket]) -> None:
        if self._is_closed:
            for each in (connection, *pool):
                each.close()
            return
        connection.settimeout(0)
        self._connection, self._missed = connection, 0
        self._loop.watch(connection, self._on_readable, self._on_lost)
        if self._role != WATCH:
            self._beat(connection)
        if identity == self._identity:
            for each in pool:
                each.close()
        else:
            self._identity = identity
            self._renew(pool)

    def _renew(self, pool: list[socket.socket]) -> None:
        """Leave the former cell, which is gone, and do in the new one what was done there."""
        if self.side:
            self.side.abandon()
        try:
            self.side = self._open_side(pool)
        except SourceError:
            self.side = None
            self.renew()
            return
        log.info("in the cell of %s", self.access.node)
        for step in self._steps:
            step(self.side)

    def _on_readable(self) -> None:
        if self._connection and not self._connection.recv(1):
            raise WireError("its stopper or the cell has ended")

    def _on_lost(self, error: Exception) -> None:
        log.warning("the cell of %s: %s", self.access.node, error)
        self._disconnect()
        self._loop.call_later(_RETRY_S, self._look)

    def _disconnect(self) -> None:
        connection, self._connection = self._connection, None
        if connection:
            self._loop.forget(connection)

    def _beat(self, connection: socket.socket) -> None:
        if connection is self._connection:
            with suppress(OSError):  # full: it hangs; closed: the loop sees that
                connection.send(GUARD_BEAT)
            self._loop.call_later(BEAT_S, lambda: self._beat(connection))
