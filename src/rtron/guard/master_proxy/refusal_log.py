"""Saying what was refused: each once a second for a caller and a reason, and not too many."""

import logging
from collections.abc import Callable

from rtron.guard.core.log_throttle import PERIOD, Seldom

log = logging.getLogger(__name__)

_MOST = 20
_LONGEST = 200


class Refusals:
    """The log of what the fence refuses; a flood of callers with new names does not fill it."""

    def __init__(self, now: Callable[[], int]) -> None:
        self._now = now
        self._seldom = Seldom()
        self._since = now()
        self._said = self._unsaid = 0

    def note(self, caller: object, method: str, why: str) -> None:
        """Log that a caller's call was refused."""
        now = self._now()
        if now - self._since >= PERIOD:
            self._begin(now)
        who = str(caller)[:_LONGEST]
        if self._said >= _MOST:
            self._unsaid += 1
        elif self._seldom.may_say((who, why), now):
            self._said += 1
            log.warning("refused: %s to %s: %s", method[:_LONGEST], ascii(who), why)

    def _begin(self, now: int) -> None:
        """Begin a new second; what was said in earlier ones no longer matters."""
        if self._unsaid:
            log.warning("refused: %d more", self._unsaid)
        self._seldom = Seldom()
        self._since = now
        self._said = self._unsaid = 0
