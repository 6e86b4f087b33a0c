"""The processes of this machine, by the process id in their own namespace.

A container in our network may count its processes from 1 again (pid_namespaces(7)): its ids differ
from those that we see, and from inside it no process outside is visible.
"""

import os
from collections import defaultdict
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtron.vocabulary import SECOND

Process = tuple[int, int]
"""A process id and its start time in the kernel's ticks: ids are used again."""

_FIRST_NAMESPACE = "pid:[4026531836]"
"""The namespace in which every process is visible (Linux, proc_ns.h, PROC_PID_INIT_INO)."""
_INIT_PID = 1
_LOW_BITS = 0xFFFF
_MIN_PERIOD = SECOND // 200
_CACHE_TIMEOUT = SECOND
"""No process id is used again within this time."""
_ENDED_ERRORS = (FileNotFoundError, ProcessLookupError)
_ENDED = frozenset("ZX")
_STATE, _THREADS, _START_TIME = 0, 17, 19
_LIBRARIES = (b"libfastdds", b"libfastrtps")


@dataclass(frozen=True, slots=True)
class ProcessMatch:
    """The only visible process that fits; `is_certain` if no process is invisible."""

    process: Process
    is_certain: bool


class ProcessTable:
    """Finds a process by the low bits of its own id; `update` follows starts and ends."""

    def __init__(self, proc: Path = Path("/proc")) -> None:
        self._proc = proc
        self._namespace_pids: dict[int, int | None] = {}
        self._pids_by_low_bits: dict[int, list[int]] = {}
        self._sees_all_processes = False
        self._updated_at = 0

    def update(self, now: int) -> None:
        """Read the processes that run at `now` (ns), except those known for less than a second."""
        if self._namespace_pids and now - self._updated_at < _MIN_PERIOD:
            return
        if now - self._updated_at > _CACHE_TIMEOUT:
            self._namespace_pids.clear()
        self._updated_at = now
        try:
            self._namespace_pids = dict(self._running(self._namespace_pids))
        except OSError:
            self._namespace_pids = {}
        self._sees_all_processes = (
            self._namespace_pids.get(_INIT_PID) == _INIT_PID
            and None not in self._namespace_pids.values()
        )
        self._pids_by_low_bits = defaultdict(list)
        for pid, namespace_pid in self._namespace_pids.items():
            if namespace_pid is not None:
                self._pids_by_low_bits[namespace_pid & _LOW_BITS].append(pid)

    def find(self, low: int) -> ProcessMatch | None:
        """Return the only process whose own id ends in these 16 bits, if it has Fast DDS loaded."""
        pids = self._pids_by_low_bits.get(low, ())
        with suppress(OSError):  # the process has ended
            process = self.process(pids[0]) if len(pids) == 1 else None
            if process and self._has_fast_dds(process[0]):
                return ProcessMatch(
                    process, self._sees_all_processes and self._is_in_our_network(process[0])
                )
        return None

    def is_running(self, process: Process) -> bool:
        """Return whether a process runs; True if that cannot be read."""
        try:
            return self.process(process[0]) == process
        except OSError:
            return True

    def is_proc_mounted(self) -> bool:
        """Return whether processes are visible at all; otherwise an invisible one may run."""
        return (self._proc / str(_INIT_PID)).exists()

    def process(self, pid: int) -> Process | None:
        """Return a process with its start time if it runs, even if its first thread has ended.

        OSError if that cannot be read.
        """
        try:
            stat = self._stat(pid)
        except _ENDED_ERRORS:
            return None
        ended = stat[_STATE] in _ENDED and int(stat[_THREADS]) <= 1
        return None if ended else (pid, int(stat[_START_TIME]))

    def _running(self, known: dict[int, int | None]) -> Iterator[tuple[int, int | None]]:
        """Yield each process with the id in its own namespace, None where that cannot be read."""
        names = os.listdir(self._proc)  # noqa: PTH208 - twice as fast, and twice a second
        for pid in map(int, filter(str.isdigit, names)):
            if pid in known:
                yield pid, known[pid]
            else:
                with suppress(*_ENDED_ERRORS):  # it ended after the folder was listed
                    yield pid, self._namespace_pid(pid)

    def _namespace_pid(self, pid: int) -> int | None:
        try:
            status = (self._proc / str(pid) / "status").read_text(errors="replace")
        except PermissionError:
            return None
        line = next((each for each in status.splitlines() if each.startswith("NSpid:")), "")
        ids = line.split()[1:]
        return int(ids[-1]) if ids else None

    def _is_in_our_network(self, pid: int) -> bool:
        """Return whether all processes are visible to us, and this one is in our network."""
        ours, theirs = self._proc / "self/ns", self._proc / str(pid) / "ns"
        near = (ours / "net").readlink() == (theirs / "net").readlink()
        return near and str((ours / "pid").readlink()) == _FIRST_NAMESPACE

    def _stat(self, pid: int) -> list[str]:
        """Return a process's fields from its state on (proc(5), /proc/pid/stat)."""
        text = (self._proc / str(pid) / "stat").read_text(errors="replace")
        return text.rpartition(")")[2].split()

    def _has_fast_dds(self, pid: int) -> bool:
        maps = (self._proc / str(pid) / "maps").read_bytes()
        return any(library in maps for library in _LIBRARIES)
