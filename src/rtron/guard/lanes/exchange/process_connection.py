"""The connection of the command process and the bulk process: calls both ways, by name.

Messages are pickles, each with its length, on a Unix socket. Only processes of the guard's user are
spoken to, and these could write its files and its memory.
"""

import logging
import pickle
import socket
import struct
from collections import defaultdict
from collections.abc import Callable
from typing import Any

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.transport.common.framed_channel import FramedChannel

log = logging.getLogger(__name__)
MAX_MESSAGE_BYTES = 1 << 22
"""The longest message, bytes; a longer one is not sent."""
MAX_PENDING_BYTES = 1 << 23


class ProcessConnection:
    """The other process, which comes and goes; what it is told while it is away is lost.

    A call without a handler is nobody's: parts that only some guards have take part in it.
    """

    def __init__(self, loop: EventLoop) -> None:
        self.connect_listeners: list[Callable[[], None]] = []
        self.loss_listeners: list[Callable[[], None]] = []
        self._loop = loop
        self._handlers: dict[str, list[Callable[..., object]]] = defaultdict(list)
        self._channel: MessageChannel | None = None

    @property
    def is_connected(self) -> bool:
        """Whether the other process is there."""
        return self._channel is not None

    @property
    def is_ready(self) -> bool:
        """Whether the other process is there and has read what it was told."""
        return self._channel is not None and not self._channel.has_pending

    def on(self, **handlers: Callable[..., object]) -> None:
        """Call these, too, with the arguments of the other process's calls of their names."""
        for name, handler in handlers.items():
            self._handlers[name].append(handler)

    def call(self, name: str, *arguments: object) -> None:
        """Call what the other process has under a name."""
        self.send((name, *arguments))

    def send(self, call: tuple[object, ...]) -> None:
        """Make a call: its name and its arguments."""
        if self._channel:
            self._channel.send(call)

    def _open_channel(self, sock: socket.socket) -> None:
        self._channel = MessageChannel(self._loop, sock, self._receive, self._on_lost)

    def _receive(self, call: Any) -> None:  # noqa: ANN401 - what `send` has sent
        name, *arguments = call
        for handler in self._handlers.get(name, ()):
            handler(*arguments)

    def _on_lost(self) -> None:
        self._channel = None
        for listener in self.loss_listeners:
            listener()


class MessageChannel(FramedChannel):
    """Sends and receives objects."""

    HEAD = struct.Struct("=I")
    MAX_PENDING = MAX_PENDING_BYTES

    def __init__(
        self,
        loop: EventLoop,
        sock: socket.socket,
        on_message: Callable[[object], None],
        on_lost: Callable[[], None],
    ) -> None:
        super().__init__(loop, sock, on_lost)
        self._on_message = on_message
        self._log_throttle = LogThrottle()

    def send(self, message: object) -> None:
        """Send a message, now or as soon as there is room; nothing after the end.

        A message that is too long is refused: the other ones matter, and it would come again.
        """
        body = pickle.dumps(message)
        if len(body) <= MAX_MESSAGE_BYTES:
            self._put(body)
        else:
            name = message[0] if isinstance(message, tuple) else type(message).__name__
            self._log_refusal(name, len(body))

    def _log_refusal(self, name: str, size: int) -> None:
        if self._log_throttle.allows(name, self._loop.now()):
            log.error("a %s of %d bytes is too long for the guard's other process", name, size)

    def _longest_body(self, *_head: int) -> int:
        return MAX_MESSAGE_BYTES

    def _receive(self, body: bytes, *_head: int) -> None:
        self._on_message(pickle.loads(body))  # noqa: S301 - a process of our own user
