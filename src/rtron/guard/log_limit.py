"""A bound on how much a log grows: strangers decide how often some lines are written.

A connection that says nothing, a call that is none, a handshake that is broken off: each is worth a
line, and a hundred thousand a minute are worth no more than a few. Each place in the code that logs
may write a hundred lines at once, and one a second after that.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

BURST: Final = 100
"""How many lines a place in the code may write at once."""
PERIOD_S: Final = 1.0
"""After how long it may write one more, in seconds."""


@dataclass(slots=True)
class _Place:
    """What a place in the code may still write, and how much was left out since it last did."""

    lines: float
    filled_at: float
    omitted: int = 0


class LogLimit(logging.Filter):
    """Lets through what a log has room for; the last line before a gap and the first after say so.

    `now` is a clock in seconds that is never set back.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._now = now
        self._places: dict[tuple[str, int], _Place] = {}

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether the record is to be written."""
        now = self._now()
        key = record.pathname, record.lineno
        place = self._places.setdefault(key, _Place(BURST, now))
        place.lines = min(BURST, place.lines + (now - place.filled_at) / PERIOD_S)
        place.filled_at = now
        if place.lines < 1:
            place.omitted += 1
            return False
        place.lines -= 1
        _note_gaps(record, place)
        place.omitted = 0
        return True


def _note_gaps(record: logging.LogRecord, place: _Place) -> None:
    """Add to a line what was left out before it, and that more may be left out after it."""
    before = f" (after {place.omitted} such lines that were left out)" if place.omitted else ""
    after = " (if more such lines come, one a second is written)" if place.lines < 1 else ""
    if before or after:
        record.msg, record.args = f"{record.getMessage()}{before}{after}", None
