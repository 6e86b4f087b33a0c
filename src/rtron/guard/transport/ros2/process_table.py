"""The processes of this machine, by the id that each knows itself by.

A container may count its processes from 1 again while it stands in our network
(pid_namespaces(7)): its ids are others than those that we see it by, and who looks from inside
sees nobody outside.
"""

import os
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtron.vocabulary import SECOND

Process = tuple[int, int]
"""A process id and when it began, in the kernel's ticks: the ids are used again."""

_FIRST_NAMESPACE = "pid:[4026531836]"
"""The one in which every process is seen (Linux, proc_ns.h, PROC_PID_INIT_INO)."""
_FIRST = 1
_LOW = 0xFFFF
_FRESH = SECOND // 200
_STALE = SECOND
"""No process id comes round again in so short a time."""
_GONE = (FileNotFoundError, ProcessLookupError)
_ENDED = frozenset("ZX")
_STATE, _PARENT, _THREADS, _START_TIME = 0, 1, 17, 19
_LIBRARIES = (b"libfastdds", b"libfastrtps")


@dataclass(frozen=True, slots=True)
class Match:
    """The one process seen here that fits; `certain` if there is none that is not seen."""

    process: Process
    certain: bool


class Processes:
    """Finds a process by the end of its own id; `look` keeps up with who comes and goes."""

    def __init__(self, proc: Path = Path("/proc")) -> None:
        self.supervisor: Callable[[], int] = lambda: 0
        """Returns who supervises us now, by its process id, 0 if nobody does."""
        self._proc = proc
        self._own_ids: dict[int, int | None] = {}
        self._by_low: dict[int, list[int]] = {}
        self._sees_each = False
        self._looked = 0

    def look(self, now: int) -> None:
        """Know who runs at `now` (ns); who has been seen within a second is not read again."""
        if self._own_ids and now - self._looked < _FRESH:
            return
        if now - self._looked > _STALE:
            self._own_ids.clear()
        self._looked = now
        try:
            self._own_ids = dict(self._running(self._own_ids))
        except OSError:
            self._own_ids = {}
        self._sees_each = self._own_ids.get(_FIRST) == _FIRST and None not in self._own_ids.values()
        self._by_low = defaultdict(list)
        for pid, own in self._own_ids.items():
            if own is not None:
                self._by_low[own & _LOW].append(pid)

    def find(self, low: int) -> Match | None:
        """Return the one process whose own id ends in these 16 bits, if it has Fast DDS loaded."""
        found = self._by_low.get(low, ())
        with suppress(OSError):
            process = self.of(found[0]) if len(found) == 1 else None
            if process and self._has_fast_dds(process[0]):
                return Match(process, self._sees_each and self._is_near(process[0]))
        return None

    def lives(self, process: Process) -> bool:
        """Tell whether a process has not ended; it has not where that cannot be read."""
        try:
            return self.of(process[0]) == process
        except OSError:
            return True

    def are_seen(self) -> bool:
        """Tell whether anybody is to be seen at this moment: who is not, need not have ended."""
        return (self._proc / str(_FIRST)).exists()

    def of(self, pid: int) -> Process | None:
        """Return a process with its start time if it runs, be it in other threads than the first.

        OSError if that cannot be read.
        """
        try:
            stat = self._stat(pid)
        except _GONE:
            return None
        ended = stat[_STATE] in _ENDED and int(stat[_THREADS]) <= 1
        return None if ended else (pid, int(stat[_START_TIME]))

    def is_kin(self, pid: int) -> bool:
        """Tell whether a process supervises this one, has started it, or was started by it."""
        with suppress(OSError):
            near = (self.supervisor(), os.getppid())
            return pid in near or int(self._stat(pid)[_PARENT]) == os.getpid()
        return False

    def _running(self, known: dict[int, int | None]) -> Iterator[tuple[int, int | None]]:
        """Yield who runs, with the id that it knows itself by, None where that cannot be read."""
        names = os.listdir(self._proc)  # noqa: PTH208 - twice as fast, and twice a second
        for pid in map(int, filter(str.isdigit, names)):
            if pid in known:
                yield pid, known[pid]
            else:
                with suppress(*_GONE):
                    yield pid, self._own_id(pid)

    def _own_id(self, pid: int) -> int | None:
        try:
            status = (self._proc / str(pid) / "status").read_text(errors="replace")
        except PermissionError:
            return None
        line = next((each for each in status.splitlines() if each.startswith("NSpid:")), "")
        ids = line.split()[1:]
        return int(ids[-1]) if ids else None

    def _is_near(self, pid: int) -> bool:
        """Tell whether nobody is hidden from us, and a process is in our network."""
        us, it = self._proc / "self/ns", self._proc / str(pid) / "ns"
        near = (us / "net").readlink() == (it / "net").readlink()
        return near and str((us / "pid").readlink()) == _FIRST_NAMESPACE

    def _stat(self, pid: int) -> list[str]:
        """Return a process's fields from its state on (proc(5), /proc/pid/stat)."""
        text = (self._proc / str(pid) / "stat").read_text(errors="replace")
        return text.rpartition(")")[2].split()

    def _has_fast_dds(self, pid: int) -> bool:
        maps = (self._proc / str(pid) / "maps").read_bytes()
        return any(library in maps for library in _LIBRARIES)
