"""What a guard leaves to the one that takes its place: a small JSON document, kept up to date.

Written at once and whole: what was kept is there for the next guard even if this one is killed by
the next instruction.
"""

import json
import logging
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)

MOST_BYTES = 1 << 18
"""The longest will, bytes of JSON."""


class HandoverState:
    """Values by key; `inherited` gives what the guard before left, `store` what the next one finds.

    Without a supervisor nothing outlives the process: the values are kept in memory only.
    """

    def __init__(
        self, inherited: bytes = b"", write: Callable[[bytes], object] = lambda document: None
    ) -> None:
        """`inherited` is the document of the guard before; `write` keeps one of `MOST_BYTES` bytes."""
        self.last_seen_at = 0
        """When the guard before was last there, ns of the wall clock, 0 if that is not known."""
        self._write = write
        self._inherited = _values(inherited)
        self._stored = {key: _member(key, value) for key, value in self._inherited.items()}
        self._length = sum(map(len, self._stored.values()))

    def inherited(self, key: str) -> Any:  # noqa: ANN401 - any JSON value
        """Return what the guard before kept under a key; None if nothing."""
        return self._inherited.get(key)

    def store(self, key: str, value: object) -> None:
        """Leave a JSON value to the next guard, in place of what was kept under the key.

        What makes the will too long is not kept, nor what stood there before: it would be wrong.
        """
        self._drop_member(key)
        if value is not None:
            self._add_member(key, _member(key, value))
        self._write(b"{" + b",".join(self._stored.values()) + b"}")

    def _drop_member(self, key: str) -> None:
        self._length -= len(self._stored.pop(key, b""))

    def _add_member(self, key: str, member: bytes) -> None:
        if self._length + len(member) + len(self._stored) + len("{}") > MOST_BYTES:
            log.warning("%s is not left to the next guard: it is too long", key)
            return
        self._stored[key] = member
        self._length += len(member)


def _member(key: str, value: object) -> bytes:
    return f"{json.dumps(key)}:{json.dumps(value)}".encode()


def _values(document: bytes) -> dict[str, Any]:
    """Return what a will says; nothing if it is none."""
    try:
        values = json.loads(document or b"{}")
    except (ValueError, RecursionError):
        values = None
    if isinstance(values, dict):
        return values
    log.warning("what the guard before left cannot be read")
    return {}


_PERIOD_S = 1.0
_PRIVATE = 0o600


class HeartbeatFile:
    """A file whose time is that of the last sign of life.

    `previous_time` is that of the guard before, ns of the wall clock; 0 if none is known, as after a
    reboot, which ends its publishers too.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.previous_time = _modification_time(path)

    def beat(self, loop: EventLoop) -> None:
        """Leave a sign now, and each second from now on."""
        loop.call_later(_PERIOD_S, partial(self.beat, loop))
        try:
            self._path.touch(mode=_PRIVATE)
        except OSError as error:
            log.debug("the next guard will not know when this one was there: %s", error)


def heartbeat_path(control: Path, address: str) -> Path:
    """Return the file of the guard at a master or domain that listens at `control`."""
    name = "".join(each if each.isalnum() else "_" for each in address)
    return control.with_name(f"{control.stem}-{name[:64]}.seen")


def _modification_time(path: Path) -> int:
    """Return when a file was written; one of the future was, when the clock has been set since."""
    try:
        return min(path.stat().st_mtime_ns, time.time_ns())
    except OSError:
        return 0
