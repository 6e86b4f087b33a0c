"""The command process's connection to the bulk process: its board and its orders.

Nothing waits for the bulk process. While it is away, or hangs, frame rates and events count as the
worst, and the streams go on under what is in force.
"""

import logging
import os
import signal
import socket
from contextlib import suppress
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.unix_socket import peer_credentials
from rtron.guard.lanes.board import REFRESH_PERIOD, Board
from rtron.guard.lanes.board_observations import BoardObservations
from rtron.guard.lanes.channel import MessageChannel, bulk_address
from rtron.guard.lanes.command_lane import GREETING
from rtron.guard.lanes.messages import BoardChanged
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

log = logging.getLogger(__name__)

_RETRY_S = 0.1
HANG_TIMEOUT = 2 * SECOND
"""Silence after which the bulk process is killed, ns."""


class BulkConnection:
    """Connects again whenever the bulk process goes; `on_order` takes what it asks for."""

    def __init__(
        self, loop: EventLoop, master: str, board: BoardObservations, host: Coordinator
    ) -> None:
        self.on_order: Callable[[object], None] = lambda message: None
        self.connect_listeners: list[Callable[[], None]] = []
        self._loop = loop
        self._address = bulk_address(master)
        self._board = board
        self._host = host
        self._channel: MessageChannel | None = None
        self._pid = 0
        self._is_closed = False

    @property
    def is_connected(self) -> bool:
        """Whether a bulk process is there."""
        return self._channel is not None

    def pids(self) -> list[int]:
        """Return the id of the bulk process, while it is connected."""
        return [self._pid] if self._channel else []

    def open(self) -> None:
        """Connect, now or as soon as a bulk process listens, and look at its board."""
        self._connect()
        self._look()

    def send(self, message: object) -> None:
        """Tell something; without a connection it is lost."""
        if self._channel:
            self._channel.send(message)

    def close(self) -> None:
        """Connect no more."""
        self._is_closed = True
        if self._channel:
            self._channel.close()

    def _connect(self) -> None:
        if self._is_closed:
            return
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(0)
        if sock.connect_ex(self._address) or peer_credentials(sock)[1] != os.getuid():
            sock.close()
            self._loop.call_later(_RETRY_S, self._connect)
            return
        self._loop.watch(sock, lambda: self._greet(sock), lambda _: self._lose(sock))

    def _greet(self, sock: socket.socket) -> None:
        """Take the board, with which a bulk process greets."""
        greeting, descriptors, _, _ = socket.recv_fds(sock, len(GREETING), 1)
        if greeting != GREETING or not descriptors:
            raise WireError("the bulk process does not greet")
        self._pid = peer_credentials(sock)[0]
        log.info("the bulk process is there, process %d", self._pid)
        self._loop.unwatch(sock)
        self._channel = MessageChannel(self._loop, sock, self._on_message, self._on_lost)
        observations = self._board.observations
        size = (len(observations.rates.monitors), len(observations.mission.bits.by_name))
        self._use(Board(descriptors[0], *size))
        for listener in self.connect_listeners:
            listener()

    def _lose(self, sock: socket.socket) -> None:
        self._loop.forget(sock)
        self._loop.call_later(_RETRY_S, self._connect)

    def _on_lost(self) -> None:
        self._channel = None
        if not self._is_closed:
            log.error("the bulk process is gone: frame rates and events are not known")
            self._use(None)
            self._connect()

    def _use(self, board: Board | None) -> None:
        self._board.connect(board, self._loop.now())
        self._host.recheck()
        self._host.schedule_deadline()

    def _on_message(self, message: object) -> None:
        if isinstance(message, BoardChanged):
            self._update()
        else:
            self.on_order(message)

    def _look(self) -> None:
        """Look at the board now and then: what stands there may be stale."""
        if not self._is_closed:
            self._loop.call_at(self._loop.now() + REFRESH_PERIOD, self._look)
        if self._channel:
            self._update()
            self._end_hung_process()

    def _update(self) -> None:
        self._board.update(self._loop.now())
        self._host.schedule_deadline()

    def _end_hung_process(self) -> None:
        silence = self._board.view.age(self._loop.now())
        if silence > HANG_TIMEOUT and self._channel:
            log.error("the bulk process stands still: it is killed")
            with suppress(ProcessLookupError):
                os.kill(self._pid, signal.SIGKILL)
            self._channel.close()
