"""What a node reads from its environment variables."""

import os
import time
from pathlib import Path

_SLOWEST, _FASTEST = 0.25, 8.0


class CannotRun(SystemExit):
    """Why a node cannot run; uncaught, it ends the node with this line on standard error."""


def speed() -> float:
    """Return the simulated seconds in a second, from DEMO_SPEED; 1 if it is not set."""
    text = os.environ.get("DEMO_SPEED", "1")
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not _SLOWEST <= value <= _FASTEST:
        raise CannotRun(f"DEMO_SPEED is {text!r}: need {_SLOWEST:g} to {_FASTEST:g}")
    return value


def simulated_now() -> float:
    """Return simulated seconds from some moment on, for nodes without a device."""
    return time.monotonic() * speed()


def world_socket() -> str:
    """Return the path of the world's socket, from DEMO_WORLD."""
    return _require("DEMO_WORLD", "the socket of the world that has the robot's devices")


def map_file() -> Path:
    """Return the file with the static map, from DEMO_MAP."""
    return Path(_require("DEMO_MAP", "the file with the static map"))


def teleop_file() -> str:
    """Return the path of the file with a person's command, from DEMO_TELEOP; "" if not set."""
    return os.environ.get("DEMO_TELEOP", "")


def _require(name: str, what: str) -> str:
    value = os.environ.get(name)
    if not value:
        raise CannotRun(f"{name} is not set: it names {what}")
    return value
