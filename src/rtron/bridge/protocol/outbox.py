"""What waits for a client that reads slowly: bounded, the oldest messages of topics make room.

Answers are never dropped: a client that lets too many of them wait is to be closed.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

MAX_ANSWERS = 256
"""How many answers and status messages may wait."""


@dataclass(frozen=True, slots=True)
class OutgoingFrame:
    """A frame on its way to a client; `group` counts messages, 0 is none that may be dropped.

    The fragments of one message have one group.
    """

    content: str | bytes
    group: int = 0


class Outbox:
    """A queue of frames with at most `max_messages` messages of topics and `max_bytes` of all."""

    def __init__(self, max_messages: int, max_bytes: int) -> None:
        self._max_messages = max_messages
        self._max_bytes = max_bytes
        self._frames: deque[OutgoingFrame] = deque()
        self._groups: deque[int] = deque()
        self._bytes = 0
        self._answers = 0
        self._next_group = 1
        self._untold = 0
        self.dropped = 0
        """How many messages of topics were dropped so far."""

    def __len__(self) -> int:
        return len(self._frames)

    @property
    def is_overfull(self) -> bool:
        """Whether more answers wait than a client that reads at all would let wait."""
        return self._answers > MAX_ANSWERS or (not self._groups and self._bytes > self._max_bytes)

    def put_answer(self, text: str) -> None:
        """Put a frame that is not dropped."""
        self._append(OutgoingFrame(text))
        self._make_room()

    def put_message(self, frames: Iterable[str | bytes]) -> None:
        """Put a message of a topic, in one frame or several; the oldest make room for it."""
        group = self._next_group
        self._next_group += 1
        self._groups.append(group)
        for frame in frames:
            self._append(OutgoingFrame(frame, group))
        self._make_room()

    def pop(self) -> str | bytes:
        """Remove and return the oldest frame; the rest of its message is not dropped any more."""
        frame = self._frames.popleft()
        self._forget(frame)
        if frame.group and self._groups and self._groups[0] == frame.group:
            self._groups.popleft()
        return frame.content

    def take_dropped(self) -> int:
        """Return how many messages were dropped since this was asked."""
        untold, self._untold = self._untold, 0
        return untold

    def _append(self, frame: OutgoingFrame) -> None:
        self._frames.append(frame)
        self._bytes += len(frame.content)
        self._answers += not frame.group

    def _forget(self, frame: OutgoingFrame) -> None:
        self._bytes -= len(frame.content)
        self._answers -= not frame.group

    def _make_room(self) -> None:
        while len(self._groups) > self._max_messages or self._is_too_large():
            self._drop(self._groups.popleft())

    def _is_too_large(self) -> bool:
        return self._bytes > self._max_bytes and len(self._groups) > 1

    def _drop(self, group: int) -> None:
        for frame in self._frames:
            if frame.group == group:
                self._forget(frame)
        self._frames = deque(frame for frame in self._frames if frame.group != group)
        self.dropped += 1
        self._untold += 1
