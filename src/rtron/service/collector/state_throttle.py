"""What a guard is at now, passed on a few times a second, whatever it says."""

import asyncio
from collections.abc import Callable

from rtron.service.collector.close_codes import CloseCode, Closing
from rtron.vocabulary import GuardState

EACH_S = 0.1
"""So long a state stands before the next one is passed on, s."""
LARGEST = 256 << 10
"""The most bytes of a state."""
MOST = 100
"""So many states in a second end the connection; a guard tells a few."""
_SECOND = 1.0


class States:
    """Passes on the newest state with `update`, in the event loop; one for each connection."""

    def __init__(self, update: Callable[[GuardState], None]) -> None:
        self._update = update
        self._loop = asyncio.get_running_loop()
        self._newest: GuardState | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._began = self._loop.time()
        self._count = 0

    def take(self, state: GuardState, size: int) -> None:
        """Take a state that came in so many bytes; Closing if it is too large, or one too many."""
        if size > LARGEST:
            raise Closing(CloseCode.TOO_BIG, f"a state has at most {LARGEST >> 10} KiB")
        self._limit()
        self._newest = state
        if self._timer is None:
            self._pass_on()

    def stop(self) -> None:
        """Pass on nothing more."""
        if self._timer is not None:
            self._timer.cancel()

    def _limit(self) -> None:
        now = self._loop.time()
        if now - self._began >= _SECOND:
            self._began, self._count = now, 0
        self._count += 1
        if self._count > MOST:
            raise Closing(CloseCode.TOO_MUCH, f"more than {MOST} states in a second")

    def _pass_on(self) -> None:
        self._timer = None
        if self._newest is not None:
            self._update(self._newest)
            self._newest = None
            self._timer = self._loop.call_later(EACH_S, self._pass_on)
