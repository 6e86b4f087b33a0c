"""What /tb3_monitor tells of the robot."""

import json
from dataclasses import dataclass


@dataclass
class Monitored:
    """The last that was heard: position (metres) and battery (0 to 1)."""

    x: float | None = None
    y: float | None = None
    battery: float | None = None

    def text(self) -> str:
        """Return the text of the topic /monitor/state."""
        return json.dumps({"x": self.x, "y": self.y, "battery": self.battery})
