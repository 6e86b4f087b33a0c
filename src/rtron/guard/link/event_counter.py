"""How many events a life of the guard has had: written where a crash cannot take it back.

Each run counts in a file of its own, through a memory map: it costs no system call, and the kernel
keeps it whatever becomes of the process. So the link can tell how many events a guard that was
killed took with it.
"""

import logging
import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

log = logging.getLogger(__name__)

_NUMBER = struct.Struct("<Q")


class EventCounter:
    """Counts the events of this run."""

    def __init__(self, folder: Path, run: str) -> None:
        self._map: mmap.mmap | bytearray = bytearray(_NUMBER.size)
        try:
            self._map = _map_file(folder / run)
        except OSError as error:
            log.error("what a crash of the guard loses will not be counted: %s", error)  # noqa: TRY400
        self.number = 0

    def next(self) -> int:
        """Return the number of the next event, from 1 on."""
        self.number += 1
        _NUMBER.pack_into(self._map, 0, self.number)
        return self.number


def _map_file(path: Path) -> mmap.mmap:
    path.write_bytes(bytes(_NUMBER.size))
    with path.open("r+b") as file:
        return mmap.mmap(file.fileno(), _NUMBER.size)


def former_runs(folder: Path, run: str) -> Iterator[tuple[str, int]]:
    """Yield the runs before this one that are not yet forgotten, and how many events each had."""
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        data = path.read_bytes()
        if path.name != run and len(data) == _NUMBER.size:
            yield path.name, _NUMBER.unpack(data)[0]


def forget_run(folder: Path, run: str) -> None:
    """Forget a run, all of whose events are accounted for."""
    (folder / run).unlink(missing_ok=True)
