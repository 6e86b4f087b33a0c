"""The time of this machine since its start: nobody sets it, and all processes have the same."""

import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rtron.errors import SourceError

_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")


@dataclass(frozen=True, slots=True)
class MachineTime:
    """A time `now` (ns, CLOCK_MONOTONIC of clock_gettime(2)) of one life of the machine."""

    now: int
    boot: str


def check_steady_clock() -> None:
    """Check that the steady clock counts from a start; SourceError if it is faked (libfaketime)."""
    if time.monotonic_ns() < 0:
        help = "start rtron with FAKETIME_DONT_FAKE_MONOTONIC=1"
        raise SourceError("this machine's steady clock is negative", help=help)


def machine_time() -> MachineTime:
    """Return the time."""
    return MachineTime(time.monotonic_ns(), _boot_id())


@cache
def _boot_id() -> str:
    """Return what tells this life of the machine from the others (random(4)); "" if unknown."""
    try:
        return _BOOT_ID.read_text().strip()
    except OSError:
        return ""
