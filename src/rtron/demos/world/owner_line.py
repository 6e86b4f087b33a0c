"""The owner's connection to the world: a thread reads it, so the world never waits."""

import socket
from collections import deque
from contextlib import suppress
from pathlib import Path
from threading import Condition, Thread
from typing import Any

from rtron.demos.world.ground_truth import Truth
from rtron.demos.world.server.protocol import Frame, Parser, encode
from rtron.errors import SourceError, WireError

_CHUNK = 64 * 1024
_KEPT = 20_000
"""Truths that wait to be asked for; the oldest go first."""


class OwnerLine:
    """Asks and waits for the answer; keeps the truths. SourceError once the world has ended."""

    def __init__(self, path: Path) -> None:
        self._socket = _connected(path)
        self._changed = Condition()
        self._truths: deque[Truth] = deque(maxlen=_KEPT)
        self._answers: deque[dict[str, Any]] = deque()
        self._over = ""
        self._reader = Thread(target=self._read, name="the world's owner", daemon=True)
        self._reader.start()

    def ask(self, order: dict[str, Any], limit: float) -> dict[str, Any]:
        """Return the answer to an order, which may take `limit` wall s."""
        try:
            self._socket.sendall(encode(order))
        except OSError as error:
            raise SourceError(f"the world does not listen: {error}") from error
        with self._changed:
            self._changed.wait_for(lambda: self._answers or self._over, limit)
            if not self._answers:
                self._check()
                raise SourceError(f"the world did not answer for {limit:g} s")
            return self._answers.popleft()

    def truths(self, timeout: float) -> list[Truth]:
        """Return the truths since the last call; wait up to `timeout` wall s for the first."""
        with self._changed:
            self._changed.wait_for(lambda: self._truths or self._over, timeout)
            if not self._truths:
                self._check()
            found = list(self._truths)
            self._truths.clear()
        return found

    def forget(self, run: int) -> None:
        """Drop the truths of runs before `run`."""
        with self._changed:
            kept = [truth for truth in self._truths if truth.run >= run]
            self._truths.clear()
            self._truths.extend(kept)

    def close(self) -> None:
        """End the connection."""
        with suppress(OSError):  # the world was faster
            self._socket.shutdown(socket.SHUT_RDWR)
        self._reader.join()
        self._socket.close()

    def _check(self) -> None:
        if self._over:
            raise SourceError(f"the world ended the connection{self._over}")

    def _read(self) -> None:
        parser, why = Parser(), "; its log says why"
        try:
            while data := self._socket.recv(_CHUNK):
                for frame in parser.feed(data):
                    self._took(frame)
        except (OSError, WireError, KeyError, TypeError) as error:
            why = f": {error!r}"
        with self._changed:
            self._over = why
            self._changed.notify_all()

    def _took(self, frame: Frame) -> None:
        truth = frame.head.get("truth")
        with self._changed:
            if truth is None:
                self._answers.append(frame.head)
            else:
                self._truths.append(Truth.from_json(truth))
            self._changed.notify_all()


def _connected(path: Path) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.connect(str(path))
    except OSError:
        connection.close()
        raise
    return connection
