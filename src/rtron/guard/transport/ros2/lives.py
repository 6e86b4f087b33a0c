"""Which participants still live, although the domain has not said that they do not.

A node that ends in order says so. One that is killed stays in the graph until its lease is over,
20 s with Fast DDS, while the one that was started in its place is there already. On one machine
the process tells it: Fast DDS writes the host's id and the lower half of the process id into the
GID (its own choice, bytes 2 to 5), and a process that was seen there and has ended is gone. Nobody
who is already dead is ever discovered anew.
"""

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtron.vocabulary import SECOND, Word

LEASE = 25 * SECOND
"""How long a participant that is dead may be in the graph, with some to spare."""
_FAST_DDS = b"\x01\x0f"
_HOST = 4
_PID = 6
_PIDS = 1 << 16
_MOST_PIDS = 1 << 22
_ENDED = frozenset("ZX")
_PARENT = 1
_START_TIME = 19
_LIBRARIES = (b"libfastdds", b"libfastrtps")

Process = tuple[int, int]
"""A process id and when it began, in the kernel's ticks: the ids are used again."""


class Life(Word):
    """What is known of a participant: its process runs, has ended, or cannot be seen from here."""

    RUNS = "runs"
    GONE = "gone"
    UNTOLD = "untold"


@dataclass(frozen=True, slots=True)
class _Known:
    since: int
    process: Process | None


class Lives:
    """Remembers when each participant came (ns), and which process of this machine it is."""

    def __init__(
        self,
        own: bytes,
        find: Callable[[int], Process | None] | None = None,
        lives: Callable[[Process], bool] | None = None,
    ) -> None:
        """`own` is a participant of this process."""
        self.tells = own.startswith(_FAST_DDS)
        """Whether GIDs tell processes at all."""
        self._here = own[:_HOST]
        self._find = find or find_process
        self._lives = lives or process_lives
        self._known: dict[bytes, _Known] = {}

    def look(self, participants: Iterable[bytes], now: int) -> None:
        """Take all the participants that are in the graph now."""
        there = set(participants)
        self._known = {each: known for each, known in self._known.items() if each in there}
        for participant in there - self._known.keys():
            self._known[participant] = _Known(now, self._process(participant))

    def since(self, participant: bytes) -> int:
        """Return when a participant came, 0 if it is not there."""
        known = self._known.get(participant)
        return known.since if known else 0

    def of(self, participant: bytes) -> Life:
        """Return what is known of a participant at this moment."""
        known = self._known.get(participant)
        if known is None or known.process is None:
            return Life.UNTOLD
        return Life.RUNS if self._lives(known.process) else Life.GONE

    def living(self, participants: Iterable[bytes]) -> frozenset[bytes]:
        """Return those that are not known to be gone: of a name that only one has, that one."""
        found = frozenset(participants)
        if len(found) < 2:  # noqa: PLR2004 - nothing to be told apart
            return found
        return frozenset(each for each in found if self.of(each) is not Life.GONE)

    def clash(self, participants: Iterable[bytes], now: int) -> bool:
        """Tell whether two of a name's participants certainly live.

        The last to come does: it has just been discovered. Another one may be dead and unseen from
        here until a lease has passed since then.
        """
        found = sorted(self.living(participants), key=lambda each: (self.since(each), each))
        if len(found) < 2:  # noqa: PLR2004
            return False
        late = now - self.since(found[-1]) >= LEASE
        return late or any(self.of(each) is Life.RUNS for each in found[:-1])

    def process(self, participant: bytes) -> Process | None:
        """Return the process of this machine that a participant was seen in."""
        known = self._known.get(participant)
        return known.process if known else None

    def _process(self, participant: bytes) -> Process | None:
        if not self.tells or participant[:_HOST] != self._here:
            return None
        return self._find(int.from_bytes(participant[_HOST:_PID], "little"))


def find_process(low: int) -> Process | None:
    """Return the one process whose id ends in these 16 bits and that has Fast DDS loaded.

    None if there is none or several, or if it cannot be looked into (another user's, a container).
    """
    found = [
        process
        for pid in range(low, _most_pids(), _PIDS)
        if (process := process_of(pid)) and _has_fast_dds(pid)
    ]
    return found[0] if len(found) == 1 else None


def is_kin(pid: int) -> bool:
    """Tell whether a process has started this one, or was started by it."""
    return pid == os.getppid() or _parent_of(pid) == os.getpid()


def process_lives(process: Process) -> bool:
    """Tell whether a process has not ended."""
    return process_of(process[0]) == process


def process_of(pid: int) -> Process | None:
    """Return a process with its start time if it runs."""
    stat = _stat(pid)
    return (pid, int(stat[_START_TIME])) if stat and stat[0] not in _ENDED else None


def _parent_of(pid: int) -> int:
    stat = _stat(pid)
    return int(stat[_PARENT]) if stat else 0


def _stat(pid: int) -> list[str]:
    """Return a process's fields from its state on (proc(5), /proc/pid/stat), none if it is gone."""
    with suppress(OSError):
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return fields if len(fields) > _START_TIME else []
    return []


def _has_fast_dds(pid: int) -> bool:
    with suppress(OSError):
        maps = Path(f"/proc/{pid}/maps").read_bytes()
        return any(library in maps for library in _LIBRARIES)
    return False


def _most_pids() -> int:
    with suppress(OSError, ValueError):
        return min(int(Path("/proc/sys/kernel/pid_max").read_text()), _MOST_PIDS)
    return _MOST_PIDS
