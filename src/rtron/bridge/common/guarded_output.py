"""A topic that a client publishes and the guard alone hears: nothing on it is lost without a word.

Until the guard has connected, requests and goals wait for it, a moment; the transport holds them.
Velocities do not: a command that comes late moves the robot late. What cannot reach the guard is
refused, with a reason that the client gets.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

from rtron.messages import VELOCITY_TYPES
from rtron.vocabulary import SECOND, normalise_type

if TYPE_CHECKING:
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import Output

HELD_FOR = SECOND
"""How long the first messages wait for the guard, ns: as long as the transports hold them."""


class GuardedOutput:
    """Publishes what the guard hears, and says what it does not hear."""

    def __init__(
        self,
        loop: "EventLoop",
        output: "Output",
        name: str,
        type: str,
        listeners: tuple[str, ...],
        on_problem: Callable[[str], None],
    ) -> None:
        """Take the guard's nodes that hear the topic as `listeners`; none if it is not its own."""
        self._loop = loop
        self._output = output
        self._name = name
        self._listeners = listeners
        self._on_problem = on_problem
        self._may_hold = normalise_type(type) not in VELOCITY_TYPES
        self._held_until: int | None = None
        self._is_closed = False

    def publish(self, message: bytes, latched_by: str | None = None) -> None:
        """Publish a message; tell the client if the guard does not hear it."""
        if self._has_listeners() or self._hold():
            self._output.publish(message, latched_by)
        else:
            self._on_problem(f"{self._name}: the guard does not hear you yet, send it again")

    def close(self) -> None:
        """Say no more."""
        self._is_closed = True

    def _has_listeners(self) -> bool:
        if not self._listeners:
            return True
        has_listeners = any(map(self._output.is_subscribed_by, self._listeners))
        self._may_hold = self._may_hold and not has_listeners
        return has_listeners

    def _hold(self) -> bool:
        """Tell whether a message may wait for the guard; look later whether it came."""
        if not self._may_hold:
            return False
        if self._held_until is None:
            self._held_until = self._loop.now() + HELD_FOR
            self._loop.call_at(self._held_until, self._end_hold)
        return True

    def _end_hold(self) -> None:
        if not self._is_closed and self._may_hold and not self._has_listeners():
            self._may_hold = False
            self._on_problem(f"{self._name}: the guard has not come, what you sent is dropped")
