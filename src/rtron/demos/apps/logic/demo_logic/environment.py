"""What a node reads from its environment variables."""

import os
import time
from pathlib import Path


class CannotRun(SystemExit):
    """Why a node cannot run; uncaught, it ends the node with this line on standard error."""


def speed() -> float:
    """Return the simulated seconds in a second, from DEMO_SPEED; 1 if it is not set."""
    return float(os.environ.get("DEMO_SPEED", "1"))


def simulated_now() -> float:
    """Return simulated seconds from some moment on, for nodes without a device."""
    return time.monotonic() * speed()


def world_socket() -> str:
    """Return the path of the world's socket, from DEMO_WORLD."""
    return _require("DEMO_WORLD")


def map_file() -> Path:
    """Return the file with the static map, from DEMO_MAP."""
    return Path(_require("DEMO_MAP"))


def teleop_file() -> str:
    """Return the path of the file with a person's command, from DEMO_TELEOP; "" if not set."""
    return os.environ.get("DEMO_TELEOP", "")


def _require(name: str) -> str:
    value = os.environ.get(name)
    if not value:
        raise CannotRun(f"{name} is not set: `rtron demo` runs this node")
    return value
