"""The runner's side of the world: orders, and the truth as it comes."""

import socket
import time
from collections import deque
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Condition, Thread
from types import TracebackType
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


_ANSWER_LIMIT = 30.0
_PAUSE = 0.02


@dataclass(frozen=True, slots=True)
class RunSetup:
    """A run that was set up at `t` (simulated s), and its scene as the protocol has it."""

    run: int
    t: float
    scene: Mapping[str, Any]


class WorldClient:
    """Says what happens in the world. All methods raise SourceError once the world has ended."""

    def __init__(self, channel: RequestChannel, speed: float) -> None:
        self._channel = channel
        self.speed = speed
        """Simulated s a wall s."""

    @classmethod
    def connect(cls, path: Path, key: str, limit: float) -> "WorldClient":
        """Connect to the world at a socket, which may take `limit` wall s to appear."""
        channel = _open_channel(path, limit)
        try:
            welcome = channel.request({"hello": "owner", "key": key}, limit)
        except SourceError:
            channel.close()
            raise
        return cls(channel, float(welcome["speed"]))

    def reset(self, case: str, seed: int, camera_rate: float | None = None) -> RunSetup:
        """Set up the next run; the truths of earlier runs that nobody asked for are dropped."""
        optional = {} if camera_rate is None else {"camera_rate": camera_rate}
        answer = self._request("reset", case=case, seed=seed, **optional)
        self._channel.drop_older_runs(answer["run"])
        return RunSetup(answer["run"], answer["t"], answer["scene"])

    def start(self) -> float:
        """Give the mission its goal, and return when that was (simulated s)."""
        return float(self._request("start")["t"])

    def set_image_rate(self, hertz: float) -> float:
        """Let the robot's computer get through so many images a simulated s; return since when."""
        return float(self._request("rate", rate=hertz)["t"])

    def count_devices(self) -> dict[str, int]:
        """Return how many connections there are of each role."""
        return dict(self._request("devices")["roles"])

    def poll(self, timeout: float) -> list[GroundTruth]:
        """Return the truths since the last call; wait up to `timeout` wall s for the first."""
        return self._channel.truths(timeout)

    def close(self) -> None:
        """End the connection."""
        self._channel.close()

    def __enter__(self) -> "WorldClient":  # noqa: PYI034 - `Self` is not in Python 3.10
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _request(self, order: str, **rest: float | str) -> dict[str, Any]:
        return self._channel.request({"order": order, **rest}, _ANSWER_LIMIT)


def _open_channel(path: Path, limit: float) -> RequestChannel:
    deadline = time.monotonic() + limit
    while True:
        try:
            return RequestChannel(path)
        except OSError as error:
            if time.monotonic() > deadline:
                raise SourceError(f"no world at {path} after {limit:g} s: {error}") from error
        time.sleep(_PAUSE)
