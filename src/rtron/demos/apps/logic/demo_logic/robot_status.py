"""The status of the robot that /tb3_monitor publishes."""

import json
from dataclasses import dataclass


@dataclass
class RobotStatus:
    """The last position (metres) and battery (0 to 1)."""

    x: float | None = None
    y: float | None = None
    battery: float | None = None

    def text(self) -> str:
        """Return the text of the topic /monitor/state."""
        return json.dumps({"x": self.x, "y": self.y, "battery": self.battery})
