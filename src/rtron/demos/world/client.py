"""The runner's side of the world: orders, and the truth as it comes."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rtron.demos.apps.logic.demo_logic.device import Device
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.simulation import CAMERA_RATE
from rtron.errors import SourceError

_ANSWER_LIMIT = 30.0


@dataclass(frozen=True, slots=True)
class RunSetup:
    """A run that was set up at `t` (simulated s)."""

    run: int
    t: float


class WorldClient:
    """Says what happens in the world. All methods raise SourceError once the world has ended."""

    def __init__(self, device: Device) -> None:
        self._device = device
        self._truths: list[GroundTruth] = []

    @classmethod
    def connect(cls, path: Path) -> "WorldClient | None":
        """Become the owner of the world that serves at a socket; None while there is none."""
        try:
            return cls(Device("owner", str(path)))
        except SystemExit:  # which ends the nodes
            return None

    def close(self) -> None:
        """End the connection."""
        self._device.close()

    def reset(self, case: str, seed: int, camera_rate: float = CAMERA_RATE) -> RunSetup:
        """Set up the next run; the truths of earlier runs that nobody asked for are dropped."""
        answer = self._request("reset", case=case, seed=seed, camera_rate=camera_rate)
        self._truths.clear()
        return RunSetup(answer["run"], answer["t"])

    def start(self) -> float:
        """Give the mission its goal, and return when that was (simulated s)."""
        return float(self._request("start")["t"])

    def set_image_rate(self, hertz: float) -> float:
        """Let the robot's computer get through so many images a simulated s; return since when."""
        return float(self._request("rate", rate=hertz)["t"])

    def count_devices(self) -> dict[str, int]:
        """Return how many connections there are of each role that has any."""
        return dict(self._request("devices")["roles"])

    def poll(self, timeout: float) -> list[GroundTruth]:
        """Return the truths since the last call; wait up to `timeout` wall s for the first."""
        while self._device.has_frame(0.0 if self._truths else timeout):
            self._truths.append(GroundTruth.from_json(self._receive()["truth"]))
        found, self._truths = self._truths, []
        return found

    def _request(self, order: str, **values: float | str) -> dict[str, Any]:
        self._device.send(order=order, **values)
        while self._device.has_frame(_ANSWER_LIMIT):
            head = self._receive()
            if "truth" not in head:
                return head
            self._truths.append(GroundTruth.from_json(head["truth"]))
        raise SourceError(f"the world did not answer for {_ANSWER_LIMIT:g} s")

    def _receive(self) -> dict[str, Any]:
        try:
            return self._device.receive()[0]
        except (EOFError, OSError) as error:
            raise SourceError("the world ended the connection; its log says why") from error
