"""Signed heads of the service's audit log, kept on the robot: the service cannot take them back.

Who can write the service's database, and even who has its key, does not reach what robots keep: a
service that sends very many makes the file forget none, and the oldest stays for ever. A file of
JSON Lines, for `rtron audit verify --heads`.
"""

import json
import logging
import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rtron.guard.system.durable_file import replace_file

log = logging.getLogger(__name__)

MAX_LINES = 10_000
"""So many lines are kept at most, at one a minute a week; then every second of the older half goes.
"""
MAX_BURST, INTERVAL_S = 100, 10.0
"""So many lines are kept at once, then one in so many seconds; heads commit to those before."""
MAX_LINE_BYTES = 4096
_RECENT = 100
_SAMPLES = -1, -64, -1024, 0
"""Which lines the service is shown: the newest, some that are older, and the oldest."""
_PRIVATE = 0o600


class HeadsFile:
    """Keeps heads, the newest last."""

    def __init__(self, path: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` counts seconds, whatever the time is set to."""
        self._path, self._clock = path, clock
        self._allowance, self._last_time = float(MAX_BURST), clock()
        lines = _read_lines(path)
        self._lines = len(lines)
        self._last: dict[str, tuple[int, str]] = {}
        for line in lines[-_RECENT:]:
            self._note(_heads_in(line))

    def add(self, document: Mapping[str, Any]) -> None:
        """Keep heads; a full disk loses them and nothing else."""
        line = json.dumps(document).encode()
        if len(line) > MAX_LINE_BYTES:
            log.error("heads of the audit log of %d bytes are not kept", len(line))
            return
        self._note(document.get("heads"))
        if not self._is_allowed():
            return
        try:
            if self._lines >= MAX_LINES:
                self._thin_older_half()
            _append(self._path, line + b"\n")
            self._lines += 1
        except OSError as error:
            log.error("heads of the audit log are not kept: %s", error)  # noqa: TRY400

    def samples(self) -> tuple[dict[str, Any], ...]:
        """Return some of the documents, for the service to compare with its log."""
        lines = _read_lines(self._path)
        chosen = dict.fromkeys(lines[i] for i in _SAMPLES if -len(lines) <= i < len(lines))
        documents = map(_document, chosen)
        return tuple(each for each in documents if isinstance(each, dict))

    def _note(self, heads: object) -> None:
        """Note how long the chains are; log where one is shorter than it was, or another."""
        if not isinstance(heads, dict):
            return
        for chain, head in heads.items():
            if not isinstance(head, list) or len(head) != 2 or not isinstance(head[0], int):  # noqa: PLR2004 - number and hash
                continue
            number, hash = head[0], str(head[1])
            last_number, last_hash = self._last.get(chain, (0, ""))
            if number < last_number or (number == last_number and hash != last_hash):
                text = "the audit log of the service was changed: %s went from %d to %d entries"
                log.error(text, chain, last_number, number)
            self._last[chain] = number, hash

    def _is_allowed(self) -> bool:
        """Tell whether one more line may be kept now."""
        now = self._clock()
        earned = (now - self._last_time) / INTERVAL_S
        self._allowance = min(float(MAX_BURST), self._allowance + earned)
        self._last_time = now
        is_allowed = self._allowance >= 1
        self._allowance -= is_allowed
        return is_allowed

    def _thin_older_half(self) -> None:
        lines = self._path.read_bytes().splitlines(keepends=True)
        middle = len(lines) // 2
        thinned = lines[:middle:2] + lines[middle:]
        replace_file(self._path, b"".join(thinned))
        self._lines = len(thinned)


def _read_lines(path: Path) -> list[bytes]:
    try:
        return path.read_bytes().splitlines()
    except OSError:
        return []


def _heads_in(line: bytes) -> object:
    document = _document(line)
    return document.get("heads") if isinstance(document, dict) else None


def _document(line: bytes) -> object:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


def _append(path: Path, line: bytes) -> None:
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, _PRIVATE), "ab") as file:
        file.write(line)
