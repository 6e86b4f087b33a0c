"""The command process's connection to the bulk process: its board, and messages both ways.

Nothing waits for the bulk process. While it is away, or hangs, frame rates and events count as the
worst, and the streams go on under what is in force.
"""

import logging
import socket
from collections import deque

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.exchange.board import GREETING, REFRESH_PERIOD, Board
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.guard.system.process_port import connect
from rtron.guard.transport.ros2.participants import MAX_LEASE
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

_RETRY_S = 0.1
_MAX_FORMER = 8


class BulkConnection(ProcessConnection):
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
        super().__init__(loop)
        self._port, self._configuration = port, configuration
        self._board = board
        self._host = host
        self._ungreeted: socket.socket | None = None
        self._connected_at = 0
        self._participant = b""
        self._former_participants: deque[tuple[bytes, int]] = deque(maxlen=_MAX_FORMER)
        self._is_closed = False
        self.on(board_changed=self._update, participant=self._take_participant)

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
        self._open_channel(sock)
        observations = self._board.observations
        size = (len(observations.rates.monitors), len(observations.mission.bits.by_name))
        self._use(Board(descriptors[0], *size))
        for listener in self.connect_listeners:
            listener()

    def _lose(self, sock: socket.socket) -> None:
        self._loop.forget(sock)
        self._loop.call_later(_RETRY_S, self._connect)

    def _on_lost(self) -> None:
        if self._participant:
            self._former_participants.append((self._participant, self._loop.now()))
        super()._on_lost()
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

    def _take_participant(self, participant: bytes) -> None:
        self._participant = participant

    def _look(self) -> None:
        """Look at the board now and then: what stands there may be stale."""
        if not self._is_closed:
            self._loop.call_at(self._loop.now() + REFRESH_PERIOD, self._look)
        if self._channel:
            self._update()

    def _update(self) -> None:
        self._board.update(self._loop.now())
        self._host.schedule_deadline()
