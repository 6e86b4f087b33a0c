"""A connection to one subscriber: its queue is bounded, and it delays no other one."""

import fcntl
import logging
import socket
import struct
import termios
from collections.abc import Callable
from contextlib import suppress
from functools import partial

from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.guard.transport.common.backlog import Backlog
from rtron.guard.transport.common.protocol import SubscriberProgress
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.tcpros import MAX_HEADER, FrameReader, decode_header, encode_header

log = logging.getLogger(__name__)

_COUNT = struct.Struct("=i")
_SOCK_DIAG_BY_FAMILY, _NLM_F_REQUEST = 20, 1
"""linux/sock_diag.h, linux/netlink.h"""
_HEADER = struct.Struct("=IHHII")
"""nlmsghdr: length, type, flags, sequence, port"""
_REQUEST = struct.Struct("=BBBBI2s2s16s16sIII")
"""inet_diag_req_v2: family, protocol, extensions, padding, states; ports, addresses, interface and
cookie of the socket (linux/inet_diag.h)"""
_RECEIVE_QUEUE_AT = _HEADER.size + 56
"""Where inet_diag_msg has `idiag_rqueue`, behind the family, the socket and `idiag_expires`."""
_ANY = 0xFFFFFFFF
_MOST_ANSWER = 1 << 12


class KernelQueues:
    """Asks the kernel about connected TCP sockets."""

    def __init__(self, network: Network = HOST_NETWORK) -> None:
        self._diag = network.open_diag()

    def close(self) -> None:
        """Ask no more."""
        if self._diag:
            self._diag.close()
            self._diag = None

    def untaken(self, sock: socket.socket) -> int | None:
        """Return how many bytes of what `sock` has sent are known to wait.

        None if the kernel cannot be asked now, or the socket is closed.
        """
        try:
            count = fcntl.ioctl(sock, termios.TIOCOUTQ, bytes(_COUNT.size))
            return int(_COUNT.unpack(count)[0]) + self._unread_here(sock)
        except (OSError, ValueError):  # ValueError: it has no descriptor any more
            return None

    def _unread_here(self, sock: socket.socket) -> int:
        """Return how many bytes the other end has not read, 0 if it is on another machine."""
        if self._diag is None:
            return 0
        with suppress(BlockingIOError):  # an answer that nobody waited for
            self._diag.recv(_MOST_ANSWER)
        self._diag.send(_request(sock))
        answer = self._diag.recv(_MOST_ANSWER)
        is_found = len(answer) >= _RECEIVE_QUEUE_AT + _COUNT.size and (
            _HEADER.unpack_from(answer)[1] == _SOCK_DIAG_BY_FAMILY
        )
        return int(_COUNT.unpack_from(answer, _RECEIVE_QUEUE_AT)[0]) if is_found else 0


def _request(sock: socket.socket) -> bytes:
    """Return the question for the other end of a connection."""
    family = sock.family
    (near, near_port), (far, far_port) = sock.getsockname()[:2], sock.getpeername()[:2]
    body = _REQUEST.pack(
        *(family, socket.IPPROTO_TCP, 0, 0, _ANY),
        *(far_port.to_bytes(2, "big"), near_port.to_bytes(2, "big")),
        *(socket.inet_pton(family, far), socket.inet_pton(family, near)),
        *(0, _ANY, _ANY),
    )
    size = _HEADER.size + len(body)
    return _HEADER.pack(size, _SOCK_DIAG_BY_FAMILY, _NLM_F_REQUEST, 0, 0) + body


_HANDSHAKE_TIMEOUT_S = 10.0
_CHUNK = 1 << 16
_BATCH = 64
MAX_NAME = 256
"""The longest name that a subscriber may have, bytes; ROS names are short."""
_MAX_REASON = 1000


class SubscriberLink:
    """One accepted TCPROS connection, from its header to its end.

    The queue of a slow subscriber is bounded; the oldest message is dropped and counted, as in
    roscpp's publisher queue.
    """

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_header: Callable[["SubscriberLink", dict[str, str]], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._on_header = on_header
        self._header = FrameReader(MAX_HEADER)
        self._unsent_head: memoryview | None = None
        self._queue = Backlog(1)
        self._gathered: list[bytes] = []
        self._is_gathering = False
        self.on_close: Callable[[SubscriberLink], None] = lambda link: None
        self.node = ""
        self.md5sum = ""
        self.is_closed = False
        self.sent = self.sent_bytes = self._taken = 0
        loop.watch(sock, self._on_readable, self._on_error)
        loop.call_later(_HANDSHAKE_TIMEOUT_S, self._close_without_header)

    @property
    def dropped(self) -> int:
        """How many messages were dropped because the subscriber was too slow."""
        return self._queue.dropped

    def set_queue_size(self, size: int) -> None:
        """Set how many messages may wait."""
        self._queue.limit = size

    @property
    def address(self) -> str:
        """The subscriber's address, for people."""
        try:
            host, port = self._sock.getpeername()[:2]
        except OSError:
            return "closed"
        return f"{host}:{port}"

    def progress(self, queues: KernelQueues) -> SubscriberProgress:
        """Return how far the subscriber has come; the kernel is asked where it may have moved."""
        untaken = queues.untaken(self._sock) if self._taken != self.sent_bytes else 0
        if untaken is None:
            return SubscriberProgress(self.node, self.address, taken=None, is_awaited=True)
        self._taken = self.sent_bytes - untaken
        is_awaited = bool(untaken or self._unsent_head is not None or self._queue)
        return SubscriberProgress(self.node, self.address, self._taken, is_awaited)

    def accept(self, fields: dict[str, str]) -> None:
        """Accept the header; messages may follow."""
        self._enqueue(encode_header(fields))

    def refuse(self, why: str) -> None:
        """Answer the header with an error, as ROS 1 does, and close the connection."""
        why = why[:_MAX_REASON]
        log.warning("subscriber %s at %s refused: %s", self._label, self.address, why)
        self._enqueue(encode_header({"error": why}))
        self._flush()
        self.close()

    def send(self, message: bytes) -> None:
        """Send a message, or let it wait while the subscriber is slow.

        The first of an event goes at once, those behind it together when the event is handled.
        """
        if self._is_gathering:
            self._gathered.append(message)
            return
        self._is_gathering = True
        self._loop.call_after_event(self._flush)
        self.sent += 1
        if self._unsent_head is None:
            self._enqueue(message)
        else:
            self._queue.append(message)

    def close(self) -> None:
        """Close the connection; messages that wait count as dropped."""
        if self.is_closed:
            return
        self.is_closed = True
        self._queue.clear()
        self._loop.forget(self._sock)
        self.on_close(self)

    def _flush(self) -> None:
        self._is_gathering = False
        if not self._gathered:
            return
        gathered, self._gathered = self._gathered, []
        if self.is_closed:
            return
        self.sent += len(gathered)
        for at in range(0, len(gathered), _BATCH):
            self._queue_messages(gathered[at : at + _BATCH])

    def _queue_messages(self, messages: list[bytes]) -> None:
        if self._unsent_head is None:
            self._enqueue(b"".join(messages))
            return
        for message in messages:
            self._queue.append(message)

    def _enqueue(self, data: bytes) -> None:
        """Write to the socket; the rest that the kernel does not take becomes the head.

        After an error the link closes when the event is handled: its publication sends to others.
        """
        try:
            written = self._sock.send(data)
        except BlockingIOError:
            written = 0
        except OSError as error:
            self._loop.call_after_event(partial(self._on_error, error))
            return
        self.sent_bytes += written
        if written < len(data):
            self._unsent_head = memoryview(data)[written:]
            self._loop.await_writable(self._sock, self._on_writable)

    def _on_writable(self) -> None:
        head, self._unsent_head = self._unsent_head, None
        if head is not None:
            self._enqueue(head)  # type: ignore[arg-type]
        while self._unsent_head is None and self._queue:
            self._enqueue(self._queue.pop())
        if self._unsent_head is None and not self.is_closed:
            self._loop.await_writable(self._sock, None)

    def _on_readable(self) -> None:
        data = self._sock.recv(_CHUNK)
        if not data:
            raise WireError("closed by the subscriber")
        if self.md5sum:
            return
        for frame in self._header.feed(data)[:1]:
            fields = decode_header(frame[4:])
            self.node = fields.get("callerid", "")
            self.md5sum = fields.get("md5sum", "")
            if not self.md5sum:
                raise WireError("the header has no md5sum")
            self._check_name()
            if not self.is_closed:
                self._on_header(self, fields)

    def _check_name(self) -> None:
        size = len(self.node.encode())
        if size > MAX_NAME:
            self.refuse(f"its name has {size} bytes, the limit is {MAX_NAME}")

    @property
    def _label(self) -> str:
        return printable(self.node) or "?"

    def _close_without_header(self) -> None:
        if not self.md5sum and not self.is_closed:
            self._on_error(WireError("no connection header in time"))

    def _on_error(self, error: Exception) -> None:
        if not self.is_closed:
            log.info("subscriber %s at %s: %s", self._label, self.address, error)
            self.close()
