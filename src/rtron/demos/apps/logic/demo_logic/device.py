"""A device of the robot: a connection to the world, which plays the hardware.

Frames of its protocol are `!II` (bytes of head and of blob), a JSON object, and raw bytes.
"""

import json
import socket
import struct
from collections.abc import Iterator
from contextlib import suppress
from select import select
from threading import Lock
from typing import Any

from .environment import CannotRun, world_socket

Head = dict[str, Any]
Frame = tuple[Head, bytes]
LENGTHS = struct.Struct("!II")
"""What each frame begins with."""


def encode(head: Head, blob: bytes = b"") -> bytes:
    """Return a frame; ValueError if the head has NaN or infinity."""
    text = json.dumps(head, allow_nan=False).encode()
    return LENGTHS.pack(len(text), len(blob)) + text + blob


class Device:
    """One device: iterate over it for its frames, `send` to it from any thread.

    The iteration ends when the world ends or `close` is called, which may be in another thread.
    CannotRun if there is no world.
    """

    def __init__(self, role: str, path: str | None = None) -> None:
        self.role = role
        self._lock = Lock()
        self._socket = _connect(path or world_socket())
        self.send(hello=role)

    def __iter__(self) -> Iterator[Frame]:
        with suppress(EOFError, OSError):  # the world ended, or `close` was called
            while True:
                yield self.receive()
        self.close()

    def receive(self) -> Frame:
        """Return the next frame, however long it takes; EOFError or OSError at the world's end."""
        head, blob = LENGTHS.unpack(self._read_exactly(LENGTHS.size))
        return json.loads(self._read_exactly(head)), self._read_exactly(blob)

    def has_frame(self, timeout: float) -> bool:
        """Wait up to `timeout` seconds for a frame or the world's end; tell whether it came."""
        return bool(select([self._socket], [], [], timeout)[0])

    def send(self, **head: object) -> None:
        """Send a frame; ValueError if it has NaN or infinity. After the world's end: nothing."""
        data = encode(head)
        with self._lock, suppress(OSError):  # whoever iterates sees the end
            self._socket.sendall(data)

    def close(self) -> None:
        """End the iteration, in whichever thread it is."""
        with suppress(OSError):  # the world was faster
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def _read_exactly(self, size: int) -> bytes:
        data = b""
        while len(data) < size:  # a signal ends a call of `recv` early
            part = self._socket.recv(size - len(data), socket.MSG_WAITALL)
            if not part:
                raise EOFError(f"the connection ended {size - len(data)} bytes early")
            data += part
        return data


def _connect(path: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.connect(path)
    except OSError as error:
        connection.close()
        raise CannotRun(f"no world at {path}: {error}") from error
    return connection
