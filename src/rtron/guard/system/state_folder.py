"""Where the guard of an app keeps what must outlive it."""

import os
from pathlib import Path

INCIDENTS = "incidents"
"""The folder of incidents, in the folder of the guard's state."""


def state_folder(app: str) -> Path:
    """Return where the guard of an app keeps its state by default (XDG base folders)."""
    root = os.environ.get("XDG_STATE_HOME", "")
    base = Path(root) if Path(root).is_absolute() else Path.home() / ".local" / "state"
    name = "".join(each if each.isalnum() or each in "-_" else "_" for each in app)[:64] or "app"
    return base / "rtron" / name
