"""A call that follows a change at once, and seldom where there are many changes."""

from collections.abc import Callable

from rtron.guard.transport.common.protocol import Transport


class DelayedCall:
    """Calls a function after the event in which it is asked for, `delay` ns after the last call.

    So the first change counts at once, and many that follow cost one call.
    """

    def __init__(self, transport: Transport, delay: int, function: Callable[[], None]) -> None:
        self._transport = transport
        self._delay = delay
        self._function = function
        self._is_scheduled = False
        self._called_at = -delay

    def schedule(self) -> None:
        """Call it as soon as it may be called."""
        if not self._is_scheduled:
            self._is_scheduled = True
            due = max(self._transport.now(), self._called_at + self._delay)
            self._transport.call_at(due, self._run)

    def _run(self) -> None:
        self._is_scheduled = False
        self._called_at = self._transport.now()
        self._function()
