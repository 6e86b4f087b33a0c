"""When responses go to their clients: a few at a time, and again to who does not know us yet."""

from __future__ import annotations

import logging
from collections import deque
from typing import TYPE_CHECKING, NamedTuple

from rtron.errors import WireError
from rtron.guard.core.log_throttle import LogThrottle
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)


BURST_SIZE = 5
"""The number of responses that go at once: half the queue of a client (rmw/qos_profiles.h: 10)."""
PAUSE = SECOND // 20
"""After so long one more may go: a client may be busy for five pauses and loses none."""
MAX_PACED = 200
"""The number of responses that may wait; what is above it goes at once."""


class ResponsePacer:
    """Sends responses in order and paced: too many at once would displace each other in the queue.

    A client that cancels many goals gets as many results.
    """

    def __init__(self, loop: EventLoop) -> None:
        self._loop = loop
        self._queue: deque[Callable[[], None]] = deque()
        self._allowance = BURST_SIZE

    def send(self, send: Callable[[], None]) -> None:
        """Call `send` as soon as its turn comes."""
        self._queue.append(send)
        if len(self._queue) > MAX_PACED:
            self._queue.popleft()()
        elif self._allowance:
            self._send_next()

    def _send_next(self) -> None:
        if self._allowance == BURST_SIZE:
            self._resume_later()
        self._allowance -= 1
        self._queue.popleft()()

    def _resume_later(self) -> None:
        self._loop.call_at(self._loop.now() + PAUSE, self._resume)

    def _resume(self) -> None:
        self._allowance += 1
        if self._allowance < BURST_SIZE:
            self._resume_later()
        if self._queue:
            self._send_next()


MAX_UNSENT = 64
"""How many responses may wait for clients that do not know the service yet."""
_RETRY_PERIOD = SECOND // 2
_RETRY_TIMEOUT = 3 * SECOND
"""So long a response is sent again: a client needs up to 2 s to find a service (ns)."""


class _Unsent(NamedTuple):
    """A response to a client, by its participant; `send` returns whether it was sent."""

    client: bytes
    send: Callable[[], bool]
    until: int


class ResponseRetry:
    """Sends responses of a service again, and tells and counts those that are lost.

    An attempt that fails takes 100 ms, in which the guard does nothing else. So one may fail every
    0.5 s, and further responses to its client wait without an attempt.
    """

    def __init__(self, loop: EventLoop, service: str) -> None:
        self._loop = loop
        self._service = service
        self._unsent: deque[_Unsent] = deque()
        self._log_throttle = LogThrottle()
        self.lost = 0

    def send(self, client: bytes, send: Callable[[], bool]) -> None:
        """Call `send` now, and again while it returns False; a WireError ends that."""
        is_waiting = any(each.client == client for each in self._unsent)
        if not is_waiting and self._attempt(send):
            return
        if len(self._unsent) == MAX_UNSENT:
            self._report_lost(f"{MAX_UNSENT} wait already")
            return
        self._unsent.append(_Unsent(client, send, self._loop.now() + _RETRY_TIMEOUT))
        if len(self._unsent) == 1:
            self._retry_later()

    def _retry_later(self) -> None:
        self._loop.call_at(self._loop.now() + _RETRY_PERIOD, self._retry)

    def _retry(self) -> None:
        """Send what waits, until an attempt fails."""
        now = self._loop.now()
        while self._unsent:
            first = self._unsent.popleft()
            if now >= first.until:
                self._report_lost("its client does not know the service, or has left")
            elif not self._attempt(first.send):
                self._unsent.append(first)
                self._retry_later()
                return

    def _attempt(self, send: Callable[[], bool]) -> bool:
        try:
            return send()
        except WireError as error:
            self._report_lost(str(error))
            return True

    def _report_lost(self, why: str) -> None:
        self.lost += 1
        if self._log_throttle.allows("lost", self._loop.now()):
            text = "%s: an answer is lost: %s; %d so far"
            log.warning(text, self._service, why, self.lost)
