"""A call that follows soon after a change, once for many changes."""

from collections.abc import Callable

from rtron.guard.transport.common.protocol import Transport


class DelayedCall:
    """Calls a function `delay` ns after `schedule`, once however often that was asked for."""

    def __init__(self, transport: Transport, delay: int, function: Callable[[], None]) -> None:
        self._transport = transport
        self._delay = delay
        self._function = function
        self._is_scheduled = False

    def schedule(self) -> None:
        """Call it soon."""
        if not self._is_scheduled:
            self._is_scheduled = True
            self._transport.call_at(self._transport.now() + self._delay, self._run)

    def _run(self) -> None:
        self._is_scheduled = False
        self._function()
