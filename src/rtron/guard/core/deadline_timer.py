"""When a stream has something to do although nobody speaks."""

from collections.abc import Callable
from functools import partial

from rtron.guard.transport.common.protocol import Transport


class Waking:
    """Calls `tick(now)` when it is due, and `woken` after it; `deadline` tells when that is (ns).

    Of the calls that the transport was asked for, only the earliest counts.
    """

    def __init__(
        self,
        transport: Transport,
        deadline: Callable[[], int | None],
        tick: Callable[[int], None],
        woken: Callable[[], None],
    ) -> None:
        self._transport = transport
        self._deadline = deadline
        self._tick = tick
        self._woken = woken
        self._armed_for: int | None = None

    def settle(self, now: int) -> None:
        """Do what is due, and be called when the next is."""
        due = self._deadline()
        if due is not None and due <= now:
            self._tick(now)
        self._arm()

    def rely(self) -> None:
        """Be called in time, if no call was asked for yet."""
        if self._armed_for is None:
            self._arm()

    def hasten(self, due: int | None) -> None:
        """Be called in time, if `due` is before the call that was asked for."""
        if due is not None and (self._armed_for is None or due < self._armed_for):
            self._arm()

    def _arm(self) -> None:
        """Ask to be called at the next deadline, unless an earlier call is already due."""
        due = self._deadline()
        if due is not None and (self._armed_for is None or due < self._armed_for):
            self._armed_for = due
            self._transport.call_at(due, partial(self._wake, due))

    def _wake(self, due: int) -> None:
        """Do what is due, unless an earlier call has taken the place of this one."""
        if due != self._armed_for:
            return
        self._armed_for = None
        self._tick(self._transport.now())
        self._woken()
        self._arm()
