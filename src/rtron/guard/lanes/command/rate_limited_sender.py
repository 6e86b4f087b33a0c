"""A limit to messages that strangers cause: each of their connections is told to the audit."""

import logging
from collections.abc import Callable

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

PERIOD = SECOND // 100
MAX_PER_PERIOD = 64
MAX_WAITING = 1024


class RateLimitedSender:
    """Sends a message at once, but equal ones once a period, and few in all.

    What has to wait is sent when the period ends. A message without room is lost.
    """

    def __init__(self, send: Callable[[object], None], loop: EventLoop) -> None:
        self._send = send
        self._loop = loop
        self._sent: set[object] = set()
        """What was sent in this period, which has ended if this is empty."""
        self._waiting: dict[object, None] = {}
        self._lost_count = 0
        self._log_throttle = LogThrottle()

    def send(self, message: object) -> None:
        """Send a message, now or when it is due."""
        if message not in self._sent and len(self._sent) < MAX_PER_PERIOD:
            self._send_now(message)
        elif message in self._waiting or len(self._waiting) < MAX_WAITING:
            self._waiting[message] = None
        else:
            self._count_lost()

    def _send_now(self, message: object) -> None:
        if not self._sent:
            self._loop.call_at(self._loop.now() + PERIOD, self._begin_period)
        self._sent.add(message)
        self._send(message)

    def _begin_period(self) -> None:
        self._sent.clear()
        for message in list(self._waiting)[:MAX_PER_PERIOD]:
            del self._waiting[message]
            self._send_now(message)

    def _count_lost(self) -> None:
        self._lost_count += 1
        if self._log_throttle.allows("lost", self._loop.now()):
            text = "%d messages to the audit were lost: nodes connect and disconnect too fast"
            log.warning(text, self._lost_count)
