"""The events of one guard: numbered, with the wall clock, and counted where none can be kept."""

import logging
import mmap
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Protocol

from rtron.vocabulary import EventKind, GuardEvent, GuardEventLevel

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


EventSink = Callable[[GuardEvent], None]
_MAX_REASON = 300


class RecordEvent(Protocol):
    """Records an event; `values` are the fields of a GuardEvent."""

    def __call__(
        self,
        kind: EventKind,
        level: GuardEventLevel = GuardEventLevel.INFO,
        **values: Any,  # noqa: ANN401
    ) -> None:
        """Record it."""


class EventRecorder:
    """Numbers events and hands them on.

    `has_capacity` tells whether one more can be kept: what finds no place is counted, and told as
    lost once there is place again.
    """

    def __init__(
        self,
        counter: EventCounter,
        run: str,
        sink: EventSink,
        has_capacity: Callable[[], bool],
        wall_clock: Callable[[], int],
    ) -> None:
        self.revision = 0
        self._counter = counter
        self._run = run
        self._sink = sink
        self._has_capacity = has_capacity
        self._wall_clock = wall_clock
        self._lost_count = 0

    def record(
        self,
        kind: EventKind,
        level: GuardEventLevel = GuardEventLevel.INFO,
        **values: Any,  # noqa: ANN401
    ) -> None:
        """Tell an event; `values` are the fields of a GuardEvent."""
        if not self._has_capacity():
            self._lost_count += 1
            return
        if self._lost_count:
            self._record_lost()
        self._emit(kind, level, **values)

    def _record_lost(self) -> None:
        count, self._lost_count = self._lost_count, 0
        reason = f"{count} events were lost: the link process was away for too long"
        self._emit(EventKind.LOST, GuardEventLevel.WARNING, reason=reason, values={"events": count})

    def _emit(self, kind: EventKind, level: GuardEventLevel, **values: Any) -> None:  # noqa: ANN401
        values["reason"] = str(values.get("reason", ""))[:_MAX_REASON]
        number = self._counter.next()
        values.setdefault("revision", self.revision)
        values.setdefault("at", self._wall_clock())
        self._sink(
            GuardEvent(
                run=self._run,
                number=number,
                kind=kind,
                level=level,
                **values,
            )
        )
