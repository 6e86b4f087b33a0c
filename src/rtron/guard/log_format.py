"""How a log line of a long-running process looks: time in UTC, level, process, text.

`2026-11-26T08:29:46.123Z WARNING supervisor: the guard stands still`
"""

import logging
import time

_LINE = "%(asctime)s.%(msecs)03dZ %(levelname)s {}%(message)s"
_TIME = "%Y-%m-%dT%H:%M:%S"


def start_logging(level: str, process: str = "") -> None:
    """Log to standard error from this level on; `process` names one of several that share it."""
    handler = logging.StreamHandler()
    handler.setFormatter(log_formatter(process))
    logging.basicConfig(level=level, handlers=[handler])


def log_formatter(process: str = "") -> logging.Formatter:
    """Return the format of log lines; the clock is UTC, so that logs of several robots fit."""
    formatter = logging.Formatter(_LINE.format(f"{process}: " if process else ""), _TIME)
    formatter.converter = time.gmtime
    return formatter
