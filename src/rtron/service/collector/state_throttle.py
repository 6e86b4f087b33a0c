"""What a guard is at now, passed on a few times a second, whatever it says."""

import asyncio
from collections.abc import Callable

from rtron.service.collector.close_codes import CloseCode, CloseConnectionError
from rtron.vocabulary import GuardState

MIN_INTERVAL_S = 0.1
"""So long a state stands before the next one is passed on, s."""
MAX_STATE_BYTES = 256 << 10
"""The most bytes of a state."""
MAX_STATES_PER_SECOND = 100
"""So many states in a second end the connection; a guard tells a few."""
_WINDOW_S = 1.0


class StateThrottle:
    """Passes on the newest state with `update`, in the event loop; one for each connection."""

    def __init__(self, update: Callable[[GuardState], None]) -> None:
        self._update = update
        self._loop = asyncio.get_running_loop()
        self._newest: GuardState | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._window_start = self._loop.time()
        self._count = 0

    def put(self, state: GuardState, size: int) -> None:
        """Take a state that came in so many bytes; Closing if it is too large, or one too many."""
        if size > MAX_STATE_BYTES:
            raise CloseConnectionError(
                CloseCode.TOO_BIG, f"a state has at most {MAX_STATE_BYTES >> 10} KiB"
            )
        self._check_rate()
        self._newest = state
        if self._timer is None:
            self._forward()

    def stop(self) -> None:
        """Pass on nothing more."""
        if self._timer is not None:
            self._timer.cancel()

    def _check_rate(self) -> None:
        now = self._loop.time()
        if now - self._window_start >= _WINDOW_S:
            self._window_start, self._count = now, 0
        self._count += 1
        if self._count > MAX_STATES_PER_SECOND:
            raise CloseConnectionError(
                CloseCode.TOO_MUCH, f"more than {MAX_STATES_PER_SECOND} states in a second"
            )

    def _forward(self) -> None:
        self._timer = None
        if self._newest is not None:
            self._update(self._newest)
            self._newest = None
            self._timer = self._loop.call_later(MIN_INTERVAL_S, self._forward)
