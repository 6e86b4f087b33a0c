"""A stream socket between two processes on this machine: frames, each with a head and a body."""

import logging
import socket
import struct
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)

_CHUNK = 1 << 16


class FramedChannel(ABC):
    """Sends and receives frames; the loop never waits for the other side.

    `on_lost` is called once, when the connection has ended or the other side reads nothing.
    """

    HEAD: ClassVar[struct.Struct]
    """The head of a frame; its first number is the size of the body, bytes."""
    MAX_PENDING: ClassVar[int]
    """What may wait for a process that does not read, bytes; beyond, the connection ends."""

    def __init__(self, loop: EventLoop, sock: socket.socket, on_lost: Callable[[], None]) -> None:
        self._loop = loop
        self._sock = sock
        self._on_lost = on_lost
        self._received = bytearray()
        self._pending = bytearray()
        self._is_open = True
        self._is_waiting = False
        sock.settimeout(0)
        loop.watch(sock, self._on_readable, self._on_error)

    @property
    def has_pending(self) -> bool:
        """Whether something waits for the other side to read."""
        return bool(self._pending)

    def close(self) -> None:
        """End the connection."""
        if self._is_open:
            self._is_open = False
            self._loop.forget(self._sock)
            self._on_lost()

    @abstractmethod
    def _longest_body(self, *head: int) -> int:
        """Return how long the body of a frame with this head, without its size, may be, bytes."""

    @abstractmethod
    def _receive(self, body: bytes, *head: int) -> None:
        """Take a frame: its body, and its head without the size."""

    def _put(self, body: bytes, *head: int) -> None:
        """Send a frame, now or as soon as there is room; nothing after the end."""
        if not self._is_open:
            return
        is_idle = not self._pending
        self._pending += self.HEAD.pack(len(body), *head)
        self._pending += body
        if len(self._pending) > self.MAX_PENDING:
            self.close()
        elif is_idle:
            self._flush()

    def _flush(self) -> None:
        try:
            sent = self._sock.send(memoryview(self._pending)[:_CHUNK])
        except BlockingIOError:
            sent = 0
        except OSError:
            self.close()
            return
        del self._pending[:sent]
        if self._is_waiting != bool(self._pending):
            self._is_waiting = not self._is_waiting
            self._loop.await_writable(self._sock, self._flush if self._is_waiting else None)

    def _on_error(self, error: Exception) -> None:
        log.warning("the connection to another process ends: %s", error)
        self.close()

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            self.close()
        self._received += data
        while self._is_open and self._take():
            pass

    def _take(self) -> bool:
        """Take a frame if one is complete."""
        if len(self._received) < self.HEAD.size:
            return False
        size, *head = self.HEAD.unpack_from(self._received)
        if size > self._longest_body(*head):
            raise WireError(f"the other side announces {size} bytes")
        end = self.HEAD.size + size
        if len(self._received) < end:
            return False
        body = bytes(memoryview(self._received)[self.HEAD.size : end])
        del self._received[:end]
        self._receive(body, *head)
        return True
