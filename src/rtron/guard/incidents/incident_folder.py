"""The folder of incidents: bounded, the oldest are removed, and what is removed is said."""

import fcntl
import logging
import os
import re
import time
from pathlib import Path

from rtron.guard.incidents.incident_file import PART
from rtron.guard.system.durable_file import make_private_folder
from rtron.guard.system.machine_time import machine_time
from rtron.guard.system.unix_socket import open_own_folder, runtime_folder, user_name

log = logging.getLogger(__name__)

RING = "ring"
_LOCK = "lock"
_BOOT = "boot"
_UNKNOWN = "since the start of this machine, which empties the folder of this file"
_HELP = "set XDG_RUNTIME_DIR to a folder of your own (mode 700)"
_WORD = re.compile(r"[^A-Za-z0-9]+")
_LONGEST_WORD = 40


class IncidentFolder:
    """A folder of the guard's user; OSError if it cannot be used."""

    def __init__(self, path: Path, max_bytes: int) -> None:
        """Make the folder; all incidents in it take `max_bytes` at most."""
        self.path = path
        self.ring = path / RING
        self._max_bytes = max_bytes
        make_private_folder(self.ring)
        path.chmod(0o700)
        self._lock = os.open(path / _LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)

    def lock(self) -> bool:
        """Take the folder until this process ends; False if another recorder has it.

        SourceError if others may enter the folder that tells whether the machine has started anew.
        """
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        for left in self.path.glob(f"*{PART}"):
            left.unlink(missing_ok=True)
        self._forget_other_boots()
        return True

    def _forget_other_boots(self) -> None:
        """Empty a ring whose times are those of a machine that was started anew since then."""
        boot, noted = machine_time().boot, self.ring / _BOOT
        if not boot:
            boot, noted = _UNKNOWN, _runtime_note(self.ring)
        if noted.is_file() and noted.read_text(errors="replace") == boot:
            return
        for segment in self.ring.glob("*.mcap"):
            segment.unlink(missing_ok=True)
        noted.write_text(boot)

    def close(self) -> None:
        """Let others have the folder."""
        os.close(self._lock)

    def new_path(self, at: int, kind: str, topic: str) -> Path:
        """Return where an incident of `at` (ns, wall clock) is written: no file is there yet."""
        seconds, rest = divmod(at, 10**9)
        stamp = time.strftime("%Y%m%dT%H%M%S", time.gmtime(seconds))
        about = _WORD.sub("_", topic).strip("_")[:_LONGEST_WORD]
        words = [f"{stamp}.{rest // 10**6:03d}Z", kind, *([about] if about else [])]
        return self.path / f"{'-'.join(words)}.mcap"

    def make_room(self, for_bytes: int) -> None:
        """Remove the oldest incidents until there is room for another one of this size."""
        found = sorted((each.name, each.stat().st_size, each) for each in self.path.glob("*.mcap"))
        total = sum(size for _, size, _ in found)
        for name, size, path in found:
            if total + for_bytes <= self._max_bytes:
                break
            path.unlink(missing_ok=True)
            total -= size
            log.warning("incidents: %s was removed to make room", name)


def _runtime_note(ring: Path) -> Path:
    """Return a file that the machine's next start removes; others may neither make nor keep it."""
    folder = runtime_folder()
    os.close(open_own_folder(folder, _HELP))
    return folder / user_name("ring", bytes(ring))
