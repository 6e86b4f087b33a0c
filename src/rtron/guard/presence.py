"""When the guard before was last there, also before a restart of the whole: the time of a file."""

import logging
import time
from functools import partial
from pathlib import Path

from rtron.guard.core.event_loop import EventLoop

log = logging.getLogger(__name__)

_PERIOD_S = 1.0
_PRIVATE = 0o600


class HeartbeatFile:
    """A file whose time is that of the last sign of life.

    `previous_time` is that of the guard before, ns of the wall clock; 0 if none is known, as after a
    reboot, which ends its publishers too.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self.previous_time = _modification_time(path)

    def beat(self, loop: EventLoop) -> None:
        """Leave a sign now, and each second from now on."""
        loop.call_later(_PERIOD_S, partial(self.beat, loop))
        try:
            self._path.touch(mode=_PRIVATE)
        except OSError as error:
            log.debug("the next guard will not know when this one was there: %s", error)


def heartbeat_path(control: Path, address: str) -> Path:
    """Return the file of the guard at a master or domain that listens at `control`."""
    name = "".join(each if each.isalnum() else "_" for each in address)
    return control.with_name(f"{control.stem}-{name[:64]}.seen")


def _modification_time(path: Path) -> int:
    """Return when a file was written; one of the future was, when the clock has been set since."""
    try:
        return min(path.stat().st_mtime_ns, time.time_ns())
    except OSError:
        return 0
