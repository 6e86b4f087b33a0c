"""The command process's connection to the bulk process: its board, and messages both ways.

Nothing waits for the bulk process. While it is away, or hangs, frame rates and events count as the
worst, and the streams go on under what is in force.
"""

import logging
import socket
from collections import deque
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.exchange.board import GREETING, REFRESH_PERIOD, Board
from rtron.guard.lanes.exchange.message_channel import MessageChannel
from rtron.guard.lanes.exchange.messages import (
    ApplySettings,
    BoardChanged,
    BulkParticipant,
)
from rtron.guard.system.process_port import connect
from rtron.guard.transport.ros2.participants import MAX_LEASE
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.vocabulary import Settings

log = logging.getLogger(__name__)

_RETRY_S = 0.1
_MAX_FORMER = 8


class BulkConnection:
    """Connects again whenever the bulk process goes."""

    def __init__(
        self,
        loop: EventLoop,
        port: socket.socket,
        configuration: bytes,
        board: BoardObservations,
        host: Coordinator,
    ) -> None:
        """`port` is the connecting side; a bulk process with this configuration accepts."""
        self.message_listeners: list[Callable[[object], None]] = []
        """Each takes every message of the bulk process that is not for the connection itself."""
        self.on_settings: Callable[[Settings], None] = lambda settings: None
        self.connect_listeners: list[Callable[[], None]] = []
        self.loss_listeners: list[Callable[[], None]] = []
        self._loop = loop
        self._port, self._configuration = port, configuration
        self._board = board
        self._host = host
        self._channel: MessageChannel | None = None
        self._ungreeted: socket.socket | None = None
        self._connected_at = 0
        self._participant = b""
        self._former_participants: deque[tuple[bytes, int]] = deque(maxlen=_MAX_FORMER)
        self._is_closed = False

    @property
    def is_connected(self) -> bool:
        """Whether a bulk process is there."""
        return self._channel is not None

    @property
    def is_ready(self) -> bool:
        """Whether a bulk process is there and has read what it was told."""
        return self._channel is not None and not self._channel.has_pending

    def former_participants(self) -> frozenset[bytes]:
        """Return the participants of the bulk processes before this one (ROS 2).

        These count only as long as a dead participant may stay in the graph.
        """
        since = self._loop.now() - MAX_LEASE
        return frozenset(each for each, lost_at in self._former_participants if lost_at > since)

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
        if self._ungreeted:
            self._loop.forget(self._ungreeted)

    def _connect(self) -> None:
        if self._is_closed:
            return
        try:
            sock = self._ungreeted = connect(self._port, self._configuration)
        except OSError as error:
            log.debug("the bulk process is not reached: %s", error)
            self._loop.call_later(_RETRY_S, self._connect)
            return
        sock.settimeout(0)
        self._loop.watch(sock, lambda: self._greet(sock), lambda _: self._lose(sock))

    def _greet(self, sock: socket.socket) -> None:
        """Take the board, with which a bulk process greets."""
        greeting, descriptors, _, _ = socket.recv_fds(sock, GREETING.size, 1)
        if len(greeting) != GREETING.size or not descriptors:
            raise WireError("the bulk process does not greet")
        self._ungreeted, self._connected_at = None, self._loop.now()
        log.info("the bulk process is there, process %d", *GREETING.unpack(greeting))
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
        if self._participant:
            self._former_participants.append((self._participant, self._loop.now()))
        for listener in self.loss_listeners:
            listener()
        if not self._is_closed:
            what = "frame rates and events are not known, and nobody looks for intruders"
            log.error("the bulk process is gone: %s", what)
            self._use(None)
            self._reconnect()

    def _reconnect(self) -> None:
        """Connect again; not at once if the last connection did not last, which would go round."""
        if self._loop.now() - self._connected_at < _RETRY_S * SECOND:
            self._loop.call_later(_RETRY_S, self._connect)
        else:
            self._connect()

    def _use(self, board: Board | None) -> None:
        self._board.connect(board, self._loop.now())
        self._host.recheck()
        self._host.schedule_deadline()

    def _on_message(self, message: object) -> None:
        match message:
            case BoardChanged():
                self._update()
            case BulkParticipant(participant):
                self._participant = participant
            case ApplySettings(settings):
                self.on_settings(settings)
            case _:
                for listener in self.message_listeners:
                    listener(message)

    def _look(self) -> None:
        """Look at the board now and then: what stands there may be stale."""
        if not self._is_closed:
            self._loop.call_at(self._loop.now() + REFRESH_PERIOD, self._look)
        if self._channel:
            self._update()

    def _update(self) -> None:
        self._board.update(self._loop.now())
        self._host.schedule_deadline()
