"""The connection of the command process and the bulk process: calls both ways, by name."""

import socket
from collections import defaultdict
from collections.abc import Callable
from typing import Any

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.exchange.message_channel import MessageChannel


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
