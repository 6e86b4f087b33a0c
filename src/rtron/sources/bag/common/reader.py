"""What a bag holds, whatever its format: connections, and messages in the order of time."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from io import BufferedReader
from itertools import chain, count
from operator import itemgetter
from pathlib import Path
from typing import Literal, TypeAlias

from rtron.errors import InputError
from rtron.vocabulary import QoS

Encoding: TypeAlias = Literal["ros1", "cdr", "json"]
"""JSON is what an incident's decisions are in; bags of ROS have none."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BagConnection:
    """A stream of messages: a topic, and in ROS 1 one publisher of it (`callerid`).

    `definition` is the text of the message definition, in the format that MCAP calls
    `definition_format` (`ros1msg`, `ros2msg` or `ros2idl`); both are empty where the bag has none.
    `offered_qos` has an entry for each ROS 2 publisher the recorder saw. A connection equals only
    itself, so it is a cheap key.
    """

    topic: str
    type: str
    encoding: Encoding
    md5sum: str = ""
    definition: str = ""
    definition_format: str = ""
    callerid: str = ""
    latching: bool = False
    offered_qos: tuple[QoS, ...] = ()


Message: TypeAlias = tuple[int, BagConnection, bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class BagReader:
    """A bag that was opened: its connections, and the way to its messages.

    `skipped` are topics whose messages are not ROS messages, and why.
    """

    path: Path
    connections: tuple[BagConnection, ...]
    messages: Callable[[], Iterator[Message]]
    skipped: tuple[tuple[str, str], ...] = ()

    def __iter__(self) -> Iterator[Message]:
        """Yield (time in ns, connection, serialised message) in the order of time.

        Raise InputError where the bag is damaged, after the messages before that.
        """
        return self.messages()


def unknown_encoding(encoding: str) -> str:
    """Return why a topic is left out whose messages are encoded in some other way."""
    return f"its messages are encoded as {encoding[:50]!r}, not as ROS does"


MAX_INDEX_BYTES = 128 * 2**20
MAX_HEADER_BYTES = 2**20
MAX_CHUNK_BYTES = 256 * 2**20
MAX_CHUNK_MESSAGES = 10**6
MAX_PENDING_BYTES = 256 * 2**20
MAX_CONNECTIONS = 2**16
_MIN_BUDGET_BYTES = 4 * 2**30
_MAX_RATIO = 1000


class DamageError(ValueError):
    """Something in a bag breaks its format; whoever knows the file makes an InputError of it."""


def open_bag_file(path: Path) -> BufferedReader:
    """Open a regular file; raise InputError if it is none (a pipe would block) or is not there."""
    try:
        if path.exists() and not path.is_file():
            raise InputError("is no file", path=str(path), help="give a .bag, .mcap or .db3 file")
        return path.open("rb")
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or "cannot be read"
        raise InputError(why, path=str(path), help="check the path") from None


def damage_error(path: Path, why: str, help: str) -> InputError:
    """Return the error for a bag that breaks its format."""
    return InputError(f"the bag is damaged: {why}", path=str(path), help=help)


@dataclass(slots=True)
class DecompressionBudget:
    """What may still be unpacked of a bag: in proportion to its size, so that no bomb goes off."""

    path: Path
    remaining: int

    @classmethod
    def for_file(cls, path: Path, file_size: int) -> "DecompressionBudget":
        """Return what a file of a size may unpack to."""
        return cls(path, max(_MIN_BUDGET_BYTES, _MAX_RATIO * file_size))

    def spend(self, size: int) -> None:
        """Count a chunk before it is unpacked; raise InputError if it, or all, is too much."""
        self.remaining -= size
        if size > MAX_CHUNK_BYTES:
            raise self._exceeded(f"a chunk unpacks to {size} bytes, more than {MAX_CHUNK_BYTES}")
        if self.remaining < 0:
            raise self._exceeded(f"it unpacks to more than {_MAX_RATIO} times its size")

    def _exceeded(self, why: str) -> InputError:
        return InputError(why, path=str(self.path), help="record it again with smaller chunks")


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
