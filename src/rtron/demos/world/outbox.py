"""What waits to be sent on a connection: never much, however slow its reader is."""

from collections import deque
from collections.abc import Callable

from rtron.errors import WireError

MAX_WAITING = 64
"""Frames that must arrive."""
MAX_REPLACED_STATES = 400
"""States that were dropped for newer ones while not a byte went out."""


class SendQueue:
    """Frames that must arrive, in order, and the newest state, which replaces an older one."""

    def __init__(self) -> None:
        self._sending = memoryview(b"")
        self._waiting: deque[bytes] = deque()
        self._state: bytes | None = None
        self._dropped = 0

    def __bool__(self) -> bool:
        return bool(self._sending or self._waiting or self._state)

    def add(self, frame: bytes) -> None:
        """Send a frame whatever happens; WireError if the reader is too far behind."""
        if len(self._waiting) >= MAX_WAITING:
            raise WireError("does not read what it asked for")
        self._waiting.append(frame)

    def replace_state(self, frame: bytes) -> None:
        """Send a frame, unless a newer one comes first; WireError if nothing is read any more."""
        self._dropped += self._state is not None
        if self._dropped > MAX_REPLACED_STATES:
            raise WireError("reads nothing")
        self._state = frame

    def flush(self, send: Callable[[memoryview], int]) -> None:
        """Send as much as `send` takes; it returns how many bytes it took."""
        while self:
            if not self._sending:
                self._sending = memoryview(self._next())
            took = send(self._sending)
            self._dropped = 0 if took else self._dropped
            self._sending = self._sending[took:]
            if self._sending:
                return

    def _next(self) -> bytes:
        if self._waiting:
            return self._waiting.popleft()
        frame, self._state = self._state or b"", None
        return frame
