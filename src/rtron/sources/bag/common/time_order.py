"""Messages of chunks that overlap in time, merged without ever holding the whole bag."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import chain, count
from operator import itemgetter
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bag.common.limits import MAX_PENDING_BYTES
from rtron.sources.bag.common.reader import Message

_END_OF_TIME = 2**64
_MESSAGE_OVERHEAD_BYTES = 200

message_time = itemgetter(0)


def merge_by_time(
    starts: Sequence[int], batches: Iterable[list[Message]], path: Path
) -> Iterator[Message]:
    """Yield the messages of chunks in the order of time, those of one time in the file's.

    `starts` are the first times (ns) of the chunks, ascending; `batches` their messages, in order.
    A chunk is unpacked when its turn has come. Raise InputError if too much has to wait because
    chunks overlap, or a chunk begins before its start.
    """
    pending = _PendingMessages(path)
    for start, batch, next_start in zip(
        starts, batches, chain(starts[1:], [_END_OF_TIME]), strict=False
    ):
        if batch and batch[0][0] < start:
            raise _wrong_start_time(path)
        if pending.heap or (batch and batch[-1][0] > next_start):
            pending.add(batch)
            yield from pending.pop_until(next_start)
        else:
            yield from batch


def sort_by_time(messages: list[Message]) -> list[Message]:
    """Sort a chunk's messages in place, which costs little where they are in order."""
    messages.sort(key=message_time)
    return messages


@dataclass(slots=True)
class _PendingMessages:
    """Messages that later chunks may still come before."""

    path: Path
    heap: list[tuple[int, int, Message]] = field(default_factory=list)
    _size: int = 0
    _serial: Iterator[int] = field(default_factory=count)

    def add(self, batch: list[Message]) -> None:
        for message in batch:
            self._size += len(message[2]) + _MESSAGE_OVERHEAD_BYTES
            heappush(self.heap, (message[0], next(self._serial), message))
        if self._size > MAX_PENDING_BYTES:
            why = f"its chunks overlap by more than {MAX_PENDING_BYTES // 2**20} MiB"
            help = "write it anew in the order of time: `rosbag filter IN OUT True`, `mcap sort`"
            raise InputError(why, path=str(self.path), help=help)

    def pop_until(self, time: int) -> Iterator[Message]:
        while self.heap and self.heap[0][0] <= time:
            message = heappop(self.heap)[2]
            self._size -= len(message[2]) + _MESSAGE_OVERHEAD_BYTES
            yield message


def _wrong_start_time(path: Path) -> InputError:
    help = "make its index anew: `rosbag reindex FILE`, `mcap recover FILE -o OUT`"
    return InputError("its index gives a wrong time for a chunk", path=str(path), help=help)
