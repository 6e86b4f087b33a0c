"""The command of a person: "forwards turn" (m/s, rad/s) in a file that is there while it holds."""

from math import isfinite
from pathlib import Path

from .geometry import Velocity


def read_command(path: str) -> Velocity | None:
    """Return the velocity in a file, None if there is no such file or nothing of the kind in it."""
    try:
        forwards, turn = map(float, Path(path).read_text(encoding="utf-8").split())
    except (OSError, ValueError):
        return None
    return (forwards, turn) if isfinite(forwards) and isfinite(turn) else None
