"""The numbers that the bulk process gives to the command process: frame rates and events.

They are in memory that both have, each with the time when it was written, so that the command
process reads them when it needs them and waits for nothing. A number that is stale, or that the
writer has not finished, counts as the worst one: the image node, or who tells the event, is silent.
"""

import mmap
import os
import struct
from dataclasses import dataclass

from rtron.guard.supervision.shared_memory import DoubleBuffer
from rtron.guard.system.sealed_memory import create_sealed_memory
from rtron.policies.mission.event_bits import EventState
from rtron.vocabulary import SECOND

REFRESH_PERIOD = SECOND // 20
"""How often each number is written anew, ns."""
STALE_AFTER = SECOND // 2
"""The age from which a number counts as the worst one, ns."""
GREETING = struct.Struct("=I")
"""What a bulk process says first, and sends its board with: its process id."""
_RATE = struct.Struct("=dQQ")
_EVENT = struct.Struct("=iqbqQQ")
_NEVER = -1
_UNKNOWN = -1


@dataclass(frozen=True, slots=True)
class RateRecord:
    """A frame rate (frames a second), when the last frame came (ns, 0 never), and when written."""

    fps: float
    last_frame_at: int
    written_at: int


@dataclass(frozen=True, slots=True)
class EventRecord:
    """What is known of an eflow, and when it was written (ns)."""

    state: EventState
    written_at: int


class Board:
    """The records of `rates` fps_monitors and `events` eflows, in the plan's order."""

    def __init__(self, descriptor: int, rates: int, events: int) -> None:
        self.descriptor = descriptor
        self._memory = mmap.mmap(descriptor, _size(rates, events))
        self._end = 0
        self._rates = [self._add_buffer(_RATE.size) for _ in range(rates)]
        self._events = [self._add_buffer(_EVENT.size) for _ in range(events)]

    @classmethod
    def create(cls, rates: int, events: int) -> "Board":
        """Return one without any record."""
        return cls(create_sealed_memory("rtron-board", _size(rates, events)), rates, events)

    def write_rate(self, index: int, record: RateRecord) -> None:
        """Write the record of an fps_monitor."""
        self._rates[index].write(_RATE.pack(record.fps, record.last_frame_at, record.written_at))

    def rate(self, index: int) -> RateRecord | None:
        """Return the record of an fps_monitor; None if there is none that is whole."""
        data = self._rates[index].read()[1]
        return RateRecord(*_RATE.unpack(data)) if data else None

    def write_event(self, index: int, record: EventRecord) -> None:
        """Write the record of an eflow."""
        state = record.state
        self._events[index].write(
            _EVENT.pack(
                state.publishers,
                _NEVER if state.newest is None else state.newest,
                _UNKNOWN if state.judged is None else state.judged,
                _NEVER if state.triggered is None else state.triggered,
                state.true_count,
                record.written_at,
            )
        )

    def event(self, index: int) -> EventRecord | None:
        """Return the record of an eflow; None if there is none that is whole."""
        data = self._events[index].read()[1]
        if not data:
            return None
        publishers, newest, judged, triggered, true_count, written_at = _EVENT.unpack(data)
        state = EventState(
            publishers,
            None if newest == _NEVER else newest,
            None if judged == _UNKNOWN else bool(judged),
            None if triggered == _NEVER else triggered,
            true_count,
        )
        return EventRecord(state, written_at)

    def close(self) -> None:
        """Let go of the memory; the other process keeps it."""
        self._memory.close()
        os.close(self.descriptor)

    def _add_buffer(self, capacity: int) -> DoubleBuffer:
        at = self._end
        self._end += DoubleBuffer.size(capacity)
        return DoubleBuffer(self._memory, at, capacity)


def _size(rates: int, events: int) -> int:
    records = rates * DoubleBuffer.size(_RATE.size) + events * DoubleBuffer.size(_EVENT.size)
    return max(records, mmap.PAGESIZE)
