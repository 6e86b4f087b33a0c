"""A queue of messages, bounded in number and in bytes; the oldest make room."""

from collections import deque

from rtron.vocabulary.plan import MAX_QUEUE_BYTES


class Backlog:
    """A queue that never holds more than `limit` messages and `max_bytes` bytes."""

    __slots__ = ("_bytes", "_max_bytes", "_messages", "dropped", "limit")

    def __init__(self, limit: int, max_bytes: int = MAX_QUEUE_BYTES) -> None:
        self.limit = limit
        self.dropped = 0
        self._max_bytes = max_bytes
        self._messages: deque[bytes] = deque()
        self._bytes = 0

    def __len__(self) -> int:
        return len(self._messages)

    def append(self, message: bytes) -> None:
        """Append a message; drop and count the oldest ones that no longer fit."""
        self._messages.append(message)
        self._bytes += len(message)
        while len(self._messages) > self.limit or self._is_too_large():
            self.pop()
            self.dropped += 1

    def pop(self) -> bytes:
        """Remove and return the oldest message."""
        message = self._messages.popleft()
        self._bytes -= len(message)
        return message

    def clear(self) -> None:
        """Drop and count all messages."""
        while self._messages:
            self.pop()
            self.dropped += 1

    def _is_too_large(self) -> bool:
        return self._bytes > self._max_bytes and len(self._messages) > 1
