"""A device of the robot: a connection to the world, which plays the hardware."""

import socket
from collections.abc import Callable, Iterator
from contextlib import suppress
from threading import Lock, Thread

from .environment import CannotRun, world_socket
from .frame_codec import BrokenFrameError, Frame, Head, encode, read

_HELLO_LIMIT = 10.0


class Device:
    """One device: iterate over it for its frames, `send` to it from any thread.

    The iteration ends when the world ends or `close` is called, which may be in another thread.
    CannotRun if there is no world, or what answers is none.
    """

    def __init__(self, role: str, path: str | None = None) -> None:
        self.role = role
        self._lock = Lock()
        self._socket = _connect(path or world_socket())
        self.send(hello=role)
        self.speed = self._read_welcome()
        """Simulated seconds in a second."""

    def __iter__(self) -> Iterator[Frame]:
        with self._socket, suppress(EOFError, OSError):  # the world ended, or `close` was called
            while True:
                yield self._frame()

    def run(self, on_frame: Callable[[Head, bytes], None]) -> None:
        """Hand each frame to `on_frame` until the device ends."""
        for head, blob in self:
            on_frame(head, blob)

    def start(self, on_frame: Callable[[Head, bytes], None]) -> Thread:
        """Start `run` in a thread that does not keep the process alive, and return the thread."""
        thread = Thread(target=self.run, args=(on_frame,), name=f"{self.role} device", daemon=True)
        thread.start()
        return thread

    def send(self, **head: object) -> None:
        """Send a frame; ValueError if it has NaN or infinity. After the world's end: nothing."""
        data = encode(head)
        with self._lock, suppress(OSError):  # whoever iterates sees the end
            self._socket.sendall(data)

    def close(self) -> None:
        """End the iteration, in whichever thread it is."""
        with suppress(OSError):  # the world was faster
            self._socket.shutdown(socket.SHUT_RDWR)

    def _read_welcome(self) -> float:
        try:
            self._socket.settimeout(_HELLO_LIMIT)
            head, _ = self._frame()
            self._socket.settimeout(None)
            return float(head["speed"])
        except (EOFError, OSError, KeyError, TypeError, ValueError) as error:
            self._socket.close()
            raise CannotRun(f"the world did not welcome the {self.role}: {error!r}") from error

    def _frame(self) -> Frame:
        try:
            return read(self._read_exactly)
        except BrokenFrameError as error:
            self._socket.close()
            raise CannotRun(f"the world's {self.role}: {error}") from error

    def _read_exactly(self, size: int) -> bytes:
        parts = bytearray()
        while len(parts) < size:
            part = self._socket.recv(size - len(parts))
            if not part:
                raise EOFError(f"the connection ended {size - len(parts)} bytes early")
            parts += part
        return bytes(parts)


def _connect(path: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.connect(path)
    except OSError as error:
        connection.close()
        raise CannotRun(f"no world at {path}: {error}") from error
    return connection
