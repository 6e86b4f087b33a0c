"""What is true of the robot at a moment, as the world tells its owner."""

from dataclasses import asdict, dataclass
from typing import Any

Position = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundTruth:
    """The robot and what is around it at `t` (simulated s since the world began).

    `pose` is x, y (m) and heading (rad), `velocity` and `commanded` are m/s and rad/s; `clearance`
    is the free space around the robot's body and `distance_to_goal` that of its centre, m. The
    light is "red", "green" or "none".
    """

    t: float
    run: int
    pose: tuple[float, float, float]
    velocity: tuple[float, float]
    commanded: tuple[float, float]
    clearance: float
    collided: bool
    in_area: bool
    light: str
    pedestrians: tuple[Position, ...]
    distance_to_goal: float

    @property
    def position(self) -> Position:
        """Where the robot is."""
        return self.pose[0], self.pose[1]

    def as_json(self) -> dict[str, Any]:
        """Return the truth as the protocol has it."""
        return asdict(self)

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> "GroundTruth":
        """Return the truth in a frame of our own world."""
        lists = ("pose", "velocity", "commanded")
        pedestrians = tuple((x, y) for x, y in value["pedestrians"])
        tuples = {name: tuple(value[name]) for name in lists} | {"pedestrians": pedestrians}
        return cls(**(value | tuples))
