"""The guard's end of the link: a Unix socket in the guard's own loop, which never waits.

What is said is gathered for a moment and written at once. Events are kept until the link process
has them on disk, so that neither its end nor its absence loses one, within a bound.
"""

import errno
import logging
import socket
from collections import deque
from collections.abc import Callable

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.vocabulary import SECOND, GuardEvent
from rtron.wire.common.link_protocol import (
    MAX_EVENTS,
    MAX_MESSAGE_BYTES,
    Applied,
    CommandResponse,
    Hello,
    LeaseCommand,
    NewSettings,
    StateReport,
    Stored,
    ToGuard,
    decode_to_guard,
    encode_event,
    encode_events,
    encode_from_guard,
    prepare_codecs,
)

log = logging.getLogger(__name__)

BATCH_DELAY = SECOND * 8 // 100
"""How long events are gathered before they are written, ns: what a kill of the guard may lose."""
MAX_PENDING_EVENTS = 20_000
"""The most events that are kept for a link process that is not there."""
_RETRY_S = 0.5
_CHUNK = 1 << 16


class LinkClient:
    """Says what the guard has to say, hears what to do; connects again when the other end goes.

    `make_hello` is what to begin with, `make_state` what is so now, asked for at each connection.
    """

    def __init__(
        self,
        loop: EventLoop,
        address: bytes,
        make_hello: Callable[[], Hello],
        make_state: Callable[[], StateReport],
        on_message: Callable[[NewSettings | LeaseCommand], None],
    ) -> None:
        self._loop = loop
        self._address = address
        self._make_hello, self._make_state, self._on_message = make_hello, make_state, on_message
        self._sock: socket.socket | None = None
        self._unacknowledged: deque[tuple[int, bytes]] = deque()
        self._unsent: deque[bytes] = deque()
        self._send_buffer = bytearray()
        self._receive_buffer = b""
        self._is_batch_due = False
        self._is_closed = False
        prepare_codecs()

    @property
    def has_capacity(self) -> bool:
        """Whether one more event can be kept."""
        return len(self._unacknowledged) < MAX_PENDING_EVENTS

    def open(self) -> None:
        """Connect, now or as soon as somebody listens."""
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(0)
        code = sock.connect_ex(self._address)
        if code:
            sock.close()
            self._retry_later(code)
            return
        self._sock = sock
        self._loop.watch(sock, self._on_readable, self._disconnect)
        self._send_greeting()

    def queue_event(self, event: GuardEvent) -> None:
        """Keep an event, and write it in a moment."""
        body = encode_event(event)
        self._unacknowledged.append((event.number, body))
        if self._sock:
            self._unsent.append(body)
            self._schedule_batch()

    def send(self, message: StateReport | Applied | CommandResponse) -> None:
        """Write what is of no use later; without a connection it is lost."""
        if self._sock and len(self._send_buffer) < MAX_MESSAGE_BYTES:
            self._write(encode_from_guard(message))

    def close(self) -> None:
        """Write what is left, as far as that goes at once, and connect no more."""
        self._is_closed = True
        self._send_batch()
        if self._sock:
            self._loop.forget(self._sock)
            self._sock = None

    def _send_greeting(self) -> None:
        self._send_buffer.clear()
        self._receive_buffer = b""
        self._unsent = deque(body for _, body in self._unacknowledged)
        self._write(encode_from_guard(self._make_hello()))
        self._write(encode_from_guard(self._make_state()))
        self._schedule_batch()

    def _retry_later(self, code: int) -> None:
        if code not in (errno.ECONNREFUSED, errno.EAGAIN):
            log.warning("the link process cannot be reached: error %d", code)
        if not self._is_closed:
            self._loop.call_later(_RETRY_S, self.open)

    def _schedule_batch(self) -> None:
        if not self._is_batch_due:
            self._is_batch_due = True
            self._loop.call_at(self._loop.now() + BATCH_DELAY, self._send_batch)

    def _send_batch(self) -> None:
        self._is_batch_due = False
        if not (self._sock and self._unsent) or len(self._send_buffer) > MAX_MESSAGE_BYTES:
            return
        self._write(encode_events(self._take_batch()))
        if self._unsent:
            self._schedule_batch()

    def _take_batch(self) -> list[bytes]:
        """Take the events of one message: few enough, and short enough together."""
        batch, length = [self._unsent.popleft()], 0
        while self._unsent and len(batch) < MAX_EVENTS // 2 and length < MAX_MESSAGE_BYTES // 4:
            batch.append(self._unsent.popleft())
            length += len(batch[-1])
        return batch

    def _write(self, line: bytes) -> None:
        idle = not self._send_buffer
        self._send_buffer += line
        self._send_buffer += b"\n"
        if idle:
            self._flush()

    def _flush(self) -> None:
        if self._sock is None:
            return
        try:
            sent = self._sock.send(memoryview(self._send_buffer)[:_CHUNK])
        except BlockingIOError:
            sent = 0
        except OSError as error:
            self._disconnect(error)
            return
        del self._send_buffer[:sent]
        self._loop.await_writable(self._sock, self._flush if self._send_buffer else None)
        if not self._send_buffer and self._unsent:
            self._schedule_batch()

    def _on_readable(self) -> None:
        if self._sock is None:
            return
        data = self._sock.recv(_CHUNK)
        if not data:
            raise WireError("the link process is gone")
        *lines, self._receive_buffer = (self._receive_buffer + data).split(b"\n")
        if len(self._receive_buffer) > MAX_MESSAGE_BYTES:
            raise WireError("the link process says too much at once")
        for line in lines:
            self._receive(decode_to_guard(line))

    def _receive(self, message: ToGuard) -> None:
        if isinstance(message, NewSettings | LeaseCommand):
            self._on_message(message)
            return
        if not isinstance(message, Stored):
            raise WireError("the link process keeps what is not for the guard to itself")
        while self._unacknowledged and self._unacknowledged[0][0] <= message.number:
            self._unacknowledged.popleft()

    def _disconnect(self, error: Exception) -> None:
        if self._sock is None:
            return
        log.info("%s", error)
        self._loop.forget(self._sock)
        self._sock = None
        self._retry_later(errno.ECONNREFUSED)
