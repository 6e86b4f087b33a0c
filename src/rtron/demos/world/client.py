"""The runner's side of the world: orders, and the truth as it comes."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from rtron.demos.world.ground_truth import Truth
from rtron.demos.world.owner_line import OwnerLine
from rtron.errors import SourceError

_ANSWER_LIMIT = 30.0
_PAUSE = 0.02


@dataclass(frozen=True, slots=True)
class Begun:
    """A run that was set up at `t` (simulated s), and its scene as the protocol has it."""

    run: int
    t: float
    scene: Mapping[str, Any]


class Owner:
    """Says what happens in the world. All methods raise SourceError once the world has ended."""

    def __init__(self, line: OwnerLine, speed: float) -> None:
        self._line = line
        self.speed = speed
        """Simulated s a wall s."""

    @classmethod
    def connect(cls, path: Path, key: str, limit: float) -> "Owner":
        """Connect to the world at a socket, which may take `limit` wall s to appear."""
        line = _line(path, limit)
        try:
            welcome = line.ask({"hello": "owner", "key": key}, limit)
        except SourceError:
            line.close()
            raise
        return cls(line, float(welcome["speed"]))

    def reset(self, case: str, seed: int, camera_rate: float | None = None) -> Begun:
        """Set up the next run; the truths of earlier runs that nobody asked for are dropped."""
        asked = {} if camera_rate is None else {"camera_rate": camera_rate}
        answer = self._ask("reset", case=case, seed=seed, **asked)
        self._line.forget(answer["run"])
        return Begun(answer["run"], answer["t"], answer["scene"])

    def start(self) -> float:
        """Give the mission its goal, and return when that was (simulated s)."""
        return float(self._ask("start")["t"])

    def rate(self, hertz: float) -> float:
        """Let the robot's computer get through so many images a simulated s; return since when."""
        return float(self._ask("rate", rate=hertz)["t"])

    def devices(self) -> dict[str, int]:
        """Return how many connections there are of each role."""
        return dict(self._ask("devices")["roles"])

    def poll(self, timeout: float) -> list[Truth]:
        """Return the truths since the last call; wait up to `timeout` wall s for the first."""
        return self._line.truths(timeout)

    def close(self) -> None:
        """End the connection."""
        self._line.close()

    def __enter__(self) -> "Owner":  # noqa: PYI034 - `Self` is not in Python 3.10
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _ask(self, order: str, **rest: float | str) -> dict[str, Any]:
        return self._line.ask({"order": order, **rest}, _ANSWER_LIMIT)


def _line(path: Path, limit: float) -> OwnerLine:
    until = time.monotonic() + limit
    while True:
        try:
            return OwnerLine(path)
        except OSError as error:
            if time.monotonic() > until:
                raise SourceError(f"no world at {path} after {limit:g} s: {error}") from error
        time.sleep(_PAUSE)
