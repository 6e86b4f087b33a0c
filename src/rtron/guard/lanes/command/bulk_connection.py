"""The command process's connection to the bulk process: its board, and messages both ways.

Nothing waits for the bulk process. While it is away, or hangs, frame rates and events count as the
worst, and the streams go on under what is in force.
"""

import logging
import os
import signal
import socket
from collections import deque
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import WireError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.board_observations import BoardObservations
from rtron.guard.lanes.exchange.board import REFRESH_PERIOD, Board
from rtron.guard.lanes.exchange.bulk_socket import GREETING, BulkSocket
from rtron.guard.lanes.exchange.message_channel import MessageChannel
from rtron.guard.lanes.exchange.messages import (
    ApplySettings,
    BoardChanged,
    BulkParticipant,
)
from rtron.guard.supervision.watchdog import SchedulingDelay, Watchdog, adapt_bound
from rtron.guard.system.unix_socket import peer_credentials
from rtron.guard.transport.ros2.participants import MAX_LEASE
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.vocabulary import Settings

log = logging.getLogger(__name__)

_RETRY_S = 0.1
_MAX_FORMER = 8
_GREETING_S = 20.0
"""How long a bulk process may listen before it greets: it joins the graph in between, s."""
HANG_TIMEOUT = SECOND
"""Silence after which the bulk process is killed, ns, as `Watchdog` counts it.

Of each `REFRESH_PERIOD` between two looks it counts a half: by the clock it takes twice as long.
"""
LONGEST_HANG = 5 * SECOND
"""The same where it is late again and again: it goes after others, and is not killed for that."""


class BulkConnection:
    """Connects again whenever the bulk process goes."""

    def __init__(
        self,
        loop: EventLoop,
        configuration: str,
        board: BoardObservations,
        host: Coordinator,
    ) -> None:
        """Take the configuration's digest."""
        self.message_listeners: list[Callable[[object], None]] = []
        """Each takes every message of the bulk process that is not for the connection itself."""
        self.on_settings: Callable[[Settings], None] = lambda settings: None
        self.connect_listeners: list[Callable[[], None]] = []
        self.loss_listeners: list[Callable[[], None]] = []
        self._loop = loop
        self._place = BulkSocket(configuration)
        self._board = board
        self._host = host
        self._channel: MessageChannel | None = None
        self._pid = 0
        self._connected_at = 0
        self._watch_anew()
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
        self._place.close()

    def _connect(self) -> None:
        if self._is_closed:
            return
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(0)
        if not (self._place.connect(sock) and _is_own_process(sock)):
            sock.close()
            self._loop.call_later(_RETRY_S, self._connect)
            return
        self._loop.watch(sock, lambda: self._greet(sock), lambda _: self._lose(sock))
        self._loop.call_later(_GREETING_S, partial(self._end_silent_process, sock))

    def _end_silent_process(self, sock: socket.socket) -> None:
        """Kill a bulk process that listens and does not greet: it hangs in its start."""
        if sock.fileno() >= 0 and self._channel is None and not self._is_closed:
            log.error("the bulk process does not greet: it is killed")
            _kill(peer_credentials(sock)[0])

    def _greet(self, sock: socket.socket) -> None:
        """Take the board, with which a bulk process greets."""
        greeting, descriptors, _, _ = socket.recv_fds(sock, len(GREETING), 1)
        if greeting != GREETING or not descriptors:
            raise WireError("the bulk process does not greet")
        self._pid = peer_credentials(sock)[0]
        self._watch_anew()
        self._connected_at = self._loop.now()
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
            self._end_hung_process()

    def _update(self) -> None:
        self._board.update(self._loop.now())
        self._host.schedule_deadline()

    def _watch_anew(self) -> None:
        now = self._loop.now()
        self._watchdog = Watchdog(now)
        self._delay = SchedulingDelay(now, REFRESH_PERIOD)

    def _end_hung_process(self) -> None:
        written_at = self._board.view.written_at
        silence = self._watchdog.update(self._loop.now(), written_at)
        limit = adapt_bound(HANG_TIMEOUT, self._delay.update(written_at), LONGEST_HANG)
        if silence > limit and self._channel:
            log.error("the bulk process stands still: it is killed")
            _kill(self._pid)
            self._channel.close()


def _is_own_process(sock: socket.socket) -> bool:
    """Tell whether a process of our user is at the other end; another container's has no id."""
    pid, uid = peer_credentials(sock)
    return uid == os.getuid() and pid > 0


def _kill(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
