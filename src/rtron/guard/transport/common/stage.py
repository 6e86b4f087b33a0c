"""A transport for rehearsals: nothing of it reaches other nodes, and nothing comes by itself."""

from collections.abc import Callable

from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import MessageHandler
from rtron.messages.common.encoding import Encoding


class Stage(MemoryTransport):
    """Takes a message through the parts of its way: it arrives, is handled, and leaves.

    This one has no sockets: what is handled goes to outputs in memory that nobody listens to.
    """

    def __init__(self, encoding: Encoding, now: Callable[[], int]) -> None:
        super().__init__(encoding)
        self._now = now
        self._message = b""

    def now(self) -> int:
        """Return the time of the guard's clock, ns."""
        return self._now()

    def call_at(self, when: int, callback: Callable[[], None]) -> None:
        """Do nothing: what a deadline brings is no part of a message's way."""

    def arrive(self, message: bytes) -> None:
        """Let a message arrive, unless one waits to be handled."""
        self._message = self._message or message

    def handle(self, receive: MessageHandler) -> None:
        """Let `receive` take the message that has arrived."""
        message, self._message = self._message, b""
        if message:
            receive(message)

    def take_output(self) -> None:
        """Take what was sent."""

    def close(self) -> None:
        """Close what the stage has opened."""
