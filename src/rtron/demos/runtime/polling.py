"""Waiting for what other processes do."""

import time
from collections.abc import Callable
from typing import TypeVar

from rtron.errors import SourceError

T = TypeVar("T")
_LIMIT = 120.0
_PAUSE = 0.05
_HELP = "is the machine busy with other things? end them, or try it with --speed 1"


def wait_for(condition: Callable[[], T | None], what: str, limit: float = _LIMIT) -> T:
    """Return what `condition` gives once it is true; SourceError after `limit` seconds."""
    deadline = time.monotonic() + limit
    while not (found := condition()):
        if time.monotonic() > deadline:
            raise SourceError(f"waited {limit:g} s for {what}", help=_HELP)
        time.sleep(_PAUSE)
    return found
