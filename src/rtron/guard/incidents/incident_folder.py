"""The folder of incidents: bounded, the oldest are removed, and what is removed is said."""

import fcntl
import logging
import os
import re
import struct
import time
from collections.abc import Iterable, Iterator, Mapping
from itertools import count
from pathlib import Path

from mcap.exceptions import McapError
from mcap.records import Channel as ChannelRecord
from mcap.records import Message, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from rtron.guard.incidents.ring import LIBRARY, Channel, ChannelWriter
from rtron.guard.system.durable_file import make_private_folder
from rtron.guard.system.machine_time import machine_time
from rtron.guard.system.unix_socket import open_own_folder, runtime_folder, user_name

log = logging.getLogger(__name__)

PART = ".part"
"""What a file's name ends with that is not whole yet."""
_CHUNK_BYTES = 1 << 18
_LONGEST_RECORD = 1 << 24
_STEP = 200


def write_incident(
    segments: Iterable[Path],
    target: Path,
    span: tuple[int, int, int],
    metadata: Mapping[str, Mapping[str, str]],
    profile: str,
) -> Iterator[None]:
    """Write the messages of `span` to `target`, all or nothing.

    `span` is its begin, its end, and what is added to the ring's times, ns. Yield now and then, so
    that the caller can do something else. OSError if it cannot be written.
    """
    part = target.with_name(target.name + PART)
    try:
        with part.open("wb") as stream:
            writer = Writer(stream, chunk_size=_CHUNK_BYTES, compression=CompressionType.LZ4)
            writer.start(profile, LIBRARY)
            yield from _copy(segments, ChannelWriter(writer), span)
            for name, values in metadata.items():
                writer.add_metadata(name, dict(values))
            writer.finish()
            stream.flush()
            os.fsync(stream.fileno())
        part.rename(target)
    finally:
        part.unlink(missing_ok=True)


def _copy(
    segments: Iterable[Path], channels: ChannelWriter, span: tuple[int, int, int]
) -> Iterator[None]:
    begin, end, offset = span
    number = count(1)
    for path in segments:
        for channel, message in read_segment(path):
            if begin <= message.log_time <= end:
                channels.add(channel, message.log_time + offset, message.data)
            if next(number) % _STEP == 0:
                yield


def read_segment(path: Path) -> Iterator[tuple[Channel, Message]]:
    """Yield the messages of a segment and their channels, up to where it is torn."""
    try:
        with path.open("rb") as stream:
            yield from _messages(StreamReader(stream, record_size_limit=_LONGEST_RECORD))
    except (FileNotFoundError, McapError, struct.error, ValueError, KeyError):
        return  # it has made room meanwhile, or its end is torn


def _messages(reader: StreamReader) -> Iterator[tuple[Channel, Message]]:
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    for record in reader.records:
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, ChannelRecord):
            channels[record.id] = _channel(record, schemas[record.schema_id])
        elif isinstance(record, Message):
            yield channels[record.channel_id], record


def _channel(record: ChannelRecord, schema: Schema) -> Channel:
    return Channel(
        record.topic,
        record.message_encoding,
        schema.name,
        schema.encoding,
        schema.data.decode(),
        tuple(record.metadata.items()),
    )


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
