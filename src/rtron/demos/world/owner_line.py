"""The owner's connection to the world: a thread reads it, so the world never waits."""

import socket
from collections import deque
from contextlib import suppress
from pathlib import Path
from threading import Condition, Thread
from typing import Any

from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.server.protocol import DeviceFrame, FrameParser, encode_frame
from rtron.errors import SourceError, WireError

_CHUNK = 64 * 1024
_MAX_TRUTHS = 20_000
"""Truths that wait to be asked for; the oldest go first."""


class RequestChannel:
    """Asks and waits for the answer; keeps the truths. SourceError once the world has ended."""

    def __init__(self, path: Path) -> None:
        self._socket = _connect(path)
        self._changed = Condition()
        self._truths: deque[GroundTruth] = deque(maxlen=_MAX_TRUTHS)
        self._answers: deque[dict[str, Any]] = deque()
        self._end_reason = ""
        self._reader = Thread(target=self._read, name="the world's owner", daemon=True)
        self._reader.start()

    def request(self, message: dict[str, Any], limit: float) -> dict[str, Any]:
        """Return the answer to an order, which may take `limit` wall s."""
        try:
            self._socket.sendall(encode_frame(message))
        except OSError as error:
            raise SourceError(f"the world does not listen: {error}") from error
        with self._changed:
            self._changed.wait_for(lambda: self._answers or self._end_reason, limit)
            if not self._answers:
                self._check()
                raise SourceError(f"the world did not answer for {limit:g} s")
            return self._answers.popleft()

    def truths(self, timeout: float) -> list[GroundTruth]:
        """Return the truths since the last call; wait up to `timeout` wall s for the first."""
        with self._changed:
            self._changed.wait_for(lambda: self._truths or self._end_reason, timeout)
            if not self._truths:
                self._check()
            found = list(self._truths)
            self._truths.clear()
        return found

    def drop_older_runs(self, run: int) -> None:
        """Drop the truths of runs before `run`."""
        with self._changed:
            remaining = [truth for truth in self._truths if truth.run >= run]
            self._truths.clear()
            self._truths.extend(remaining)

    def close(self) -> None:
        """End the connection."""
        with suppress(OSError):  # the world was faster
            self._socket.shutdown(socket.SHUT_RDWR)
        self._reader.join()
        self._socket.close()

    def _check(self) -> None:
        if self._end_reason:
            raise SourceError(f"the world ended the connection{self._end_reason}")

    def _read(self) -> None:
        parser, why = FrameParser(), "; its log says why"
        try:
            while data := self._socket.recv(_CHUNK):
                for frame in parser.feed(data):
                    self._dispatch(frame)
        except (OSError, WireError, KeyError, TypeError) as error:
            why = f": {error!r}"
        with self._changed:
            self._end_reason = why
            self._changed.notify_all()

    def _dispatch(self, frame: DeviceFrame) -> None:
        truth = frame.head.get("truth")
        with self._changed:
            if truth is None:
                self._answers.append(frame.head)
            else:
                self._truths.append(GroundTruth.from_json(truth))
            self._changed.notify_all()


def _connect(path: Path) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.connect(str(path))
    except OSError:
        connection.close()
        raise
    return connection
