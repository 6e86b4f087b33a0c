"""What a guard leaves to the one that takes its place: a small JSON document, kept up to date.

Written at once and whole: what was kept is there for the next guard even if this one is killed by
the next instruction.
"""

import json
import logging
from collections.abc import Callable
from typing import Any

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
