"""The ring: what happened last, in MCAP files of which the oldest make room.

A segment has no chunks (mcap.dev: MCAP specification), so each record is whole once the system has
it: what a recorder leaves that was killed can be read up to its last whole record.
"""

import re
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from mcap.writer import CompressionType, IndexType, Writer

from rtron import __version__

LIBRARY = f"rtron {__version__}"
_PARTS = 8
"""Of how many segments the ring is made, at least."""
_NAME = re.compile(r"(\d{8})-(\d{1,20})\.mcap")
_RECORD_BYTES = 31
_CHANNEL_BYTES = 64


class Channel(NamedTuple):
    """A channel and its schema; `format` is ros1msg, ros2msg or jsonschema."""

    topic: str
    encoding: str
    schema: str
    format: str
    definition: str
    metadata: tuple[tuple[str, str], ...] = ()


class ChannelWriter:
    """An MCAP writer that registers each channel and each schema when it is first used."""

    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self._channels: dict[Channel, int] = {}
        self._schemas: dict[tuple[str, str, str], int] = {}

    def add(self, channel: Channel, time: int, data: bytes) -> int:
        """Write a message of `time` (ns); return about how many bytes that took."""
        id = self._channels.get(channel)
        taken = _RECORD_BYTES + len(data)
        if id is None:
            id = self._register(channel)
            taken += _CHANNEL_BYTES + sum(map(len, channel[:5])) + len(repr(channel.metadata))
        self.writer.add_message(id, time, data, time)
        return taken

    def _register(self, channel: Channel) -> int:
        schema = (channel.schema, channel.format, channel.definition)
        if schema not in self._schemas:
            encoded = channel.definition.encode(errors="replace")
            self._schemas[schema] = self.writer.register_schema(schema[0], schema[1], encoded)
        id = self.writer.register_channel(
            channel.topic, channel.encoding, self._schemas[schema], dict(channel.metadata)
        )
        self._channels[channel] = id
        return id


class _Segment:
    """A file that is being written."""

    def __init__(self, path: Path, begin: int, profile: str) -> None:
        self.path, self.begin, self.size = path, begin, 0
        self._stream = path.open("xb")
        self._writer = Writer(
            self._stream,
            compression=CompressionType.NONE,
            index_types=IndexType.NONE,
            use_chunking=False,
        )
        self._writer.start(profile, LIBRARY)
        self._channels = ChannelWriter(self._writer)

    def add(self, channel: Channel, time: int, data: bytes) -> None:
        self.size += self._channels.add(channel, time, data)

    def flush(self) -> None:
        self._stream.flush()

    def finish(self) -> None:
        self._writer.finish()
        self._stream.close()

    def abandon(self) -> None:
        """Close a file to which nothing more can be written."""
        with suppress(OSError):
            self._stream.close()


class _ClosedSegment(NamedTuple):
    path: Path
    begin: int
    size: int


class IncidentRing:
    """Segments in a folder: about the last `span` (ns), never more than `max_bytes`.

    OSError where the disk refuses; the next `add` tries anew. What a recorder before has left is
    part of the ring.
    """

    def __init__(self, folder: Path, *, span: int, max_bytes: int, profile: str) -> None:
        self._folder = folder
        self._span = span
        self._max_bytes = max_bytes
        self._profile = profile
        self._segment: _Segment | None = None
        self._closed = deque(sorted(_closed_segments(folder)))
        last = _NAME.fullmatch(self._closed[-1].path.name) if self._closed else None
        self._number = int(last[1]) if last else 0

    def add(self, channel: Channel, time: int, data: bytes) -> None:
        """Keep a message of `time` (ns, of a clock that is steady)."""
        try:
            segment = self._segment
            if segment is None or self._is_full(segment, time):
                segment = self._begin(time)
            segment.add(channel, time, data)
        except OSError:
            self._abandon()
            raise

    def flush(self) -> None:
        """Give what was added to the system, which keeps it whatever becomes of this process."""
        try:
            if self._segment:
                self._segment.flush()
        except OSError:
            self._abandon()
            raise

    def paths(self) -> list[Path]:
        """Return the segments, the oldest first."""
        self.flush()
        current = [self._segment.path] if self._segment else []
        return [*(each.path for each in self._closed), *current]

    def close(self) -> None:
        """Finish the segment that is being written."""
        if self._segment:
            self._finish(self._segment)

    def _is_full(self, segment: _Segment, time: int) -> bool:
        is_over = time - segment.begin >= self._span // _PARTS
        return is_over or segment.size > self._max_bytes // (2 * _PARTS)

    def _begin(self, time: int) -> _Segment:
        if self._segment:
            self._finish(self._segment)
        self._make_room(time)
        self._number += 1
        path = self._folder / f"{self._number:08d}-{time}.mcap"
        self._segment = _Segment(path, time, self._profile)
        return self._segment

    def _finish(self, segment: _Segment) -> None:
        segment.finish()
        self._segment = None
        size = segment.path.stat().st_size
        self._closed.append(_ClosedSegment(segment.path, segment.begin, size))

    def _abandon(self) -> None:
        """Leave a segment as it is; it counts with what it takes."""
        if self._segment:
            self._segment.abandon()
            with suppress(OSError):
                size = self._segment.path.stat().st_size
                self._closed.append(_ClosedSegment(self._segment.path, self._segment.begin, size))
            self._segment = None

    def _make_room(self, now: int) -> None:
        """Remove what is too old, and what leaves no room for the next segment."""
        room = self._max_bytes - self._max_bytes // _PARTS
        while self._closed and (
            sum(each.size for each in self._closed) > room or self._is_oldest_over(now)
        ):
            self._closed.popleft().path.unlink(missing_ok=True)

    def _is_oldest_over(self, now: int) -> bool:
        end = self._closed[1].begin if len(self._closed) > 1 else self._closed[0].begin
        return end <= now - self._span


def _closed_segments(folder: Path) -> list[_ClosedSegment]:
    named = ((path, _NAME.fullmatch(path.name)) for path in folder.iterdir())
    return [
        _ClosedSegment(path, int(match[2]), path.stat().st_size) for path, match in named if match
    ]
