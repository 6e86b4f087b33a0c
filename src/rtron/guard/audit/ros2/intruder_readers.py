"""What intruders say on the private outputs, read by the guard itself beside the drivers.

A reader exists only while an intruder may speak: each message costs the guard some time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.common.audit_response import EndpointTrust
from rtron.guard.transport.ros2.data_reader import DataListener
from rtron.vocabulary import SECOND, output_topic
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtron.guard.audit.common.alarm_response import AlarmResponse
    from rtron.guard.audit.common.audit_response import ListenRequest
    from rtron.guard.transport.ros2.data_reader import DataReader
    from rtron.guard.transport.ros2.middleware import Ros2Transport

_PERIOD = SECOND // 2
"""How often it is checked which streams are to be read, ns: a stream may learn its stop late."""


class IntruderReaders:
    """A reader of the output of each stream that is stopped; an `IntruderListener`.

    While there are endpoints that were dismissed, it reads the others, too.
    """

    def __init__(
        self, transport: Ros2Transport, types: Mapping[str, str], response: AlarmResponse
    ) -> None:
        """`types` are the message types by stream, "" if the plan leaves it open."""
        self._transport = transport
        self._types = {stream: type for stream, type in types.items() if type}
        self._response = response
        self._trust = EndpointTrust()
        self._returned: set[bytes] = set()
        self._readers: dict[str, _StreamReader] = {}
        self._is_open = False

    def open(self) -> None:
        """Read from now on where it is needed."""
        self._is_open = True
        self._update_periodically()

    def follow(self, request: ListenRequest) -> None:
        """Know whose messages are no intruder's."""
        if isinstance(request, EndpointTrust):
            self._trust = request
            self._returned &= request.dismissed
            self.update()

    def update(self) -> None:
        """Read the outputs of the streams that are stopped, all of them while one is dismissed."""
        if not self._is_open:
            return
        streams = self._types if self._trust.dismissed else self._response.stopped_streams
        self._read({each for each in streams if self._response.has_stop(each)})

    def _update_periodically(self) -> None:
        if self._is_open:
            self._transport.call_at(self._transport.now() + _PERIOD, self._update_periodically)
            self.update()

    def _read(self, streams: set[str]) -> None:
        needed = self._types.keys() & streams
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

    def close(self) -> None:
        """Read nothing any more."""
        self._is_open = False
        self._read(set())

    def _on_message(self, stream: str, gid: bytes, message: bytes) -> None:
        """Answer an intruder's message with the stop; one that was dismissed is back."""
        if gid[:PARTICIPANT_SIZE] in self._trust.trusted:
            return
        if stream in self._readers:
            self._readers[stream].last_message_at = self._transport.now()
        if gid in self._trust.dismissed - self._returned:
            self._returned.add(gid)
            self._response.note_return(stream, gid)
        self._response.answer(stream, message)


class _StreamReader(DataListener):
    """The reader of one output. `last_message_at` begins with the reader."""

    def __init__(
        self,
        transport: Ros2Transport,
        stream: str,
        type: str,
        on_message: Callable[[str, bytes, bytes], None],
    ) -> None:
        self._transport = transport
        self._stream = stream
        self._on_message = on_message
        self.last_message_at = transport.now()
        self._reader = transport.create_reader(output_topic(stream), type, self)
        self.close = self._reader.close

    def take(self, reader: DataReader, gid: bytes, message: bytes, number: int | None) -> bool:
        """Pass on a message that is not ours; none of them counts."""
        del reader, number
        if not self._transport.graph.is_own(gid):
            self._on_message(self._stream, gid, message)
        return False
