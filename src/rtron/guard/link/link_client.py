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
from rtron.guard.core.event_loop import Loop
from rtron.vocabulary import SECOND, GuardEvent
from rtron.wire.common.link_protocol import (
    LONGEST,
    MOST_EVENTS,
    Applied,
    Hello,
    NewSettings,
    State,
    Stored,
    event_bytes,
    events_bytes,
    guard_bytes,
    to_guard,
)

log = logging.getLogger(__name__)

GATHERING = SECOND * 8 // 100
"""How long events are gathered before they are written, ns: what a kill of the guard may lose."""
MOST = 20_000
"""The most events that are kept for a link process that is not there."""
_AGAIN_S = 0.5
_CHUNK = 1 << 16


class Line:
    """Says what the guard has to say, hears settings; connects again whenever the other end goes.

    `hello` is what to begin with, `state` what is so now, asked for at each connection.
    """

    def __init__(
        self,
        loop: Loop,
        address: bytes,
        hello: Callable[[], Hello],
        state: Callable[[], State],
        settings: Callable[[NewSettings], None],
    ) -> None:
        self._loop = loop
        self._address = address
        self._hello, self._state, self._settings = hello, state, settings
        self._sock: socket.socket | None = None
        self._kept: deque[tuple[int, bytes]] = deque()
        self._unsent: deque[bytes] = deque()
        self._out = bytearray()
        self._in = b""
        self._due = False
        self._closed = False

    @property
    def has_place(self) -> bool:
        """Whether one more event can be kept."""
        return len(self._kept) < MOST

    def open(self) -> None:
        """Connect, now or as soon as somebody listens."""
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        sock.settimeout(0)
        code = sock.connect_ex(self._address)
        if code:
            sock.close()
            self._later(code)
            return
        self._sock = sock
        self._loop.watch(sock, self._readable, self._lose)
        self._begin()

    def tell(self, event: GuardEvent) -> None:
        """Keep an event, and write it in a moment."""
        body = event_bytes(event)
        self._kept.append((event.number, body))
        if self._sock:
            self._unsent.append(body)
            self._soon()

    def say(self, message: State | Applied) -> None:
        """Write what is of no use later; without a connection it is lost."""
        if self._sock and len(self._out) < LONGEST:
            self._write(guard_bytes(message))

    def close(self) -> None:
        """Write what is left, as far as that goes at once, and connect no more."""
        self._closed = True
        self._gathered()
        if self._sock:
            self._loop.forget(self._sock)
            self._sock = None

    def _begin(self) -> None:
        self._out.clear()
        self._in = b""
        self._unsent = deque(body for _, body in self._kept)
        self._write(guard_bytes(self._hello()))
        self._write(guard_bytes(self._state()))
        self._soon()

    def _later(self, code: int) -> None:
        if code not in (errno.ECONNREFUSED, errno.EAGAIN):
            log.warning("the link process cannot be reached: error %d", code)
        if not self._closed:
            self._loop.call_later(_AGAIN_S, self.open)

    def _soon(self) -> None:
        if not self._due:
            self._due = True
            self._loop.call_at(self._loop.now() + GATHERING, self._gathered)

    def _gathered(self) -> None:
        self._due = False
        if not (self._sock and self._unsent) or len(self._out) > LONGEST:
            return
        self._write(events_bytes(self._batch()))
        if self._unsent:
            self._soon()

    def _batch(self) -> list[bytes]:
        """Take the events of one message: few enough, and short enough together."""
        batch, length = [self._unsent.popleft()], 0
        while self._unsent and len(batch) < MOST_EVENTS // 2 and length < LONGEST // 4:
            batch.append(self._unsent.popleft())
            length += len(batch[-1])
        return batch

    def _write(self, line: bytes) -> None:
        idle = not self._out
        self._out += line
        self._out += b"\n"
        if idle:
            self._flush()

    def _flush(self) -> None:
        if self._sock is None:
            return
        try:
            sent = self._sock.send(memoryview(self._out)[:_CHUNK])
        except BlockingIOError:
            sent = 0
        except OSError as error:
            self._lose(error)
            return
        del self._out[:sent]
        self._loop.await_writable(self._sock, self._flush if self._out else None)
        if not self._out and self._unsent:
            self._soon()

    def _readable(self) -> None:
        if self._sock is None:
            return
        data = self._sock.recv(_CHUNK)
        if not data:
            raise WireError("the link process is gone")
        *lines, self._in = (self._in + data).split(b"\n")
        if len(self._in) > LONGEST:
            raise WireError("the link process says too much at once")
        for line in lines:
            self._heard(to_guard(line))

    def _heard(self, message: Stored | NewSettings) -> None:
        if isinstance(message, NewSettings):
            self._settings(message)
            return
        while self._kept and self._kept[0][0] <= message.number:
            self._kept.popleft()

    def _lose(self, error: Exception) -> None:
        if self._sock is None:
            return
        log.info("%s", error)
        self._loop.forget(self._sock)
        self._sock = None
        self._later(errno.ECONNREFUSED)
