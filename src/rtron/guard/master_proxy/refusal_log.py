"""Saying what was refused: each once a second for a caller and a reason, and not too many."""

import logging
from collections.abc import Callable

from rtron.guard.core.log_throttle import PERIOD, LogThrottle

log = logging.getLogger(__name__)

_MAX_PER_PERIOD = 20
_MAX_LENGTH = 200


class RefusalLog:
    """The log of what the fence refuses; a flood of callers with new names does not fill it."""

    def __init__(self, now: Callable[[], int]) -> None:
        self._now = now
        self._log_throttle = LogThrottle()
        self._period_start = now()
        self._logged_count = self._suppressed_count = 0

    def log_refusal(self, caller: object, method: str, why: str) -> None:
        """Log that a caller's call was refused."""
        now = self._now()
        if now - self._period_start >= PERIOD:
            self._begin_period(now)
        who = str(caller)[:_MAX_LENGTH]
        if self._logged_count >= _MAX_PER_PERIOD:
            self._suppressed_count += 1
        elif self._log_throttle.allows((who, why), now):
            self._logged_count += 1
            log.warning("refused: %s to %s: %s", method[:_MAX_LENGTH], ascii(who), why)

    def _begin_period(self, now: int) -> None:
        """Begin a new second; what was said in earlier ones no longer matters."""
        if self._suppressed_count:
            log.warning("refused: %d more", self._suppressed_count)
        self._log_throttle = LogThrottle()
        self._period_start = now
        self._logged_count = self._suppressed_count = 0
