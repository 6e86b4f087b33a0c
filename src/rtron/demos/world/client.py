"""The runner's side of the world: orders, and the truth as it comes."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.owner_line import RequestChannel
from rtron.errors import SourceError

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
