"""What intruders say on the private outputs, read by the guard itself beside the drivers.

A reader exists only while an intruder may speak: each message costs the guard some time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from rtron.vocabulary import output_topic

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtron.guard.transport.ros2.data_reader import DataReader
    from rtron.guard.transport.ros2.middleware import Ros2Transport

OnMessage = Callable[[str, bytes, bytes], None]
"""Takes the public name of the stream, the publisher's GID and the message."""


class IntruderReaders:
    """A reader of each of some streams' outputs; `on_message` gets what others than us send."""

    def __init__(
        self, transport: Ros2Transport, types: Mapping[str, str], on_message: OnMessage
    ) -> None:
        """`types` are the message types by stream, "" if the plan leaves it open."""
        self._transport = transport
        self._types = {stream: type for stream, type in types.items() if type}
        self._on_message = on_message
        self._readers: dict[str, _StreamReader] = {}

    def read(self, streams: Iterable[str]) -> None:
        """Read the outputs of these streams from now on, and no others."""
        needed = self._types.keys() & set(streams)
        for stream in self._readers.keys() - needed:
            self._readers.pop(stream).close()
        for stream in needed - self._readers.keys():
            self._readers[stream] = _StreamReader(
                self._transport, stream, self._types[stream], self._on_message
            )

    def silence(self, stream: str) -> int | None:
        """Return for how long (ns) no intruder was heard on a stream, None if it is not read."""
        reader = self._readers.get(stream)
        return self._transport.now() - reader.last_message_at if reader else None

    def note_intruder(self, stream: str) -> None:
        """Note that an intruder has spoken now."""
        if stream in self._readers:
            self._readers[stream].last_message_at = self._transport.now()

    def close(self) -> None:
        """Read nothing any more."""
        self.read(())


class _StreamReader:
    """The reader of one output; a `DataListener`. `last_message_at` begins with the reader."""

    def __init__(
        self, transport: Ros2Transport, stream: str, type: str, on_message: OnMessage
    ) -> None:
        self._transport = transport
        self._stream = stream
        self._on_message = on_message
        self.last_message_at = transport.now()
        self._reader = transport.create_reader(output_topic(stream), type, self)
        self.close = self._reader.close

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> None:
        """Pass on a message that is not ours."""
        del reader, number
        if not self._transport.graph.is_own(gid):
            self._on_message(self._stream, gid, message)

    def note_late(self, reader: DataReader, gid: bytes, number: int | None) -> None:
        """Do nothing: nothing is late here."""

    def note_replaced(self, count: int) -> None:
        """Do nothing: a newer message was read."""
