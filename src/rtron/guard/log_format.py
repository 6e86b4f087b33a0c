"""How a log line of a long-running process looks, and how it gets out.

`2026-11-26T08:29:46.123Z WARNING supervisor: the guard stands still`

Names and reasons that strangers chose are in these lines: what could steer a terminal, hide, turn
around what stands beside it, or begin a line that looks like one of ours is written out.

A terminal or a pipe that nobody reads stops who writes to it. So a thread writes the lines: who
logs never waits, and a robot is stopped whether somebody reads of it or not.

Strangers decide how often some lines are written: a connection that says nothing, a call that is
none. So each place in the code may write a hundred lines at once, and one a second after that.
"""

import logging
import os
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from logging.handlers import QueueHandler
from queue import Full, Queue
from threading import Thread
from typing import Any, Final

from rtron.sanitize import sanitize

BURST: Final = 100
"""How many lines a place in the code may write at once."""
PERIOD_S: Final = 1.0
"""After how long it may write one more, in seconds."""
_LINE = "%(asctime)s.%(msecs)03dZ %(levelname)s {}%(message)s"
_TIME = "%Y-%m-%dT%H:%M:%S"
_STANDARD_ERROR = 2
_MAX_LINES = 1000
_FLUSH_S = 0.5
_POLL_S = 0.005


def start_logging(level: str, process: str = "") -> None:
    """Log to standard error from this level on; `process` names one of several that share it."""
    root = logging.getLogger()
    if not root.handlers:  # as `logging.basicConfig`: who has set it up already keeps it
        root.setLevel(level)
        root.addHandler(LogQueue(log_formatter(process)))


class LogQueue(QueueHandler):
    """Hands records to a thread that writes them; what has no room is dropped, and counted.

    The thread holds no lock of Python's files or handlers, and keeps no process from ending.
    """

    queue: "Queue[tuple[logging.LogRecord, int]]"
    """Each with how many were dropped before it."""

    def __init__(self, formatter: logging.Formatter) -> None:
        super().__init__(Queue(_MAX_LINES))
        self._format = formatter.format
        self._dropped = 0
        self._reported = 0
        self.addFilter(LogLimit())
        Thread(target=self._write, name="log", daemon=True).start()

    def enqueue(self, record: logging.LogRecord) -> None:
        """Take a record if there is room."""
        try:
            self.queue.put_nowait((record, self._dropped))
        except Full:
            self._dropped += 1

    def flush(self) -> None:
        """Wait until all is written, for half a second at most."""
        until = time.monotonic() + _FLUSH_S
        while self.queue.unfinished_tasks and time.monotonic() < until:
            time.sleep(_POLL_S)

    def _write(self) -> None:
        while True:
            record, dropped = self.queue.get()
            self._report_lost(dropped)
            self._write_line(record)
            if self.queue.empty():
                self._report_lost(self._dropped)
            self.queue.task_done()

    def _report_lost(self, dropped: int) -> None:
        if dropped > self._reported:
            self._write_line(_lost_lines(dropped - self._reported))
            self._reported = dropped

    def _write_line(self, record: logging.LogRecord) -> None:
        line = f"{self._format(record)}\n".encode(errors="backslashreplace")
        with suppress(OSError):  # nobody can read it any more
            os.write(_STANDARD_ERROR, line)


def _lost_lines(number: int) -> logging.LogRecord:
    text = "%d lines of this log are lost: nobody has read them for a while"
    return logging.LogRecord(__name__, logging.WARNING, "", 0, text, (number,), None)


class _NeutralFormatter(logging.Formatter):
    """Writes a record on one line, and what follows of an exception indented below it."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - logging's
        return sanitize(super().formatMessage(record))

    def formatException(self, ei: Any) -> str:  # noqa: N802, ANN401 - logging's
        return "\n".join(f"  {sanitize(line)}" for line in super().formatException(ei).split("\n"))


def log_formatter(process: str = "") -> logging.Formatter:
    """Return the format of log lines; the clock is UTC, so that logs of several robots fit."""
    formatter = _NeutralFormatter(_LINE.format(f"{process}: " if process else ""), _TIME)
    formatter.converter = time.gmtime
    return formatter


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
