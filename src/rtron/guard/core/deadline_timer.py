"""When a stream has something to do although nobody speaks."""

from collections.abc import Callable
from functools import partial

from rtron.guard.transport.common.protocol import Transport


class DeadlineTimer:
    """Calls `tick(now)` when it is due, and `on_tick` after it; `deadline` tells when that is (ns).

    Of the calls that the transport was asked for, only the earliest counts.
    """

    def __init__(
        self,
        transport: Transport,
        deadline: Callable[[], int | None],
        tick: Callable[[int], None],
        on_tick: Callable[[], None],
    ) -> None:
        self._transport = transport
        self._deadline = deadline
        self._tick = tick
        self._on_tick = on_tick
        self._armed_deadline: int | None = None

    def run_due(self, now: int) -> None:
        """Do what is due, and be called when the next is."""
        due = self._deadline()
        if due is not None and due <= now:
            self._tick(now)
        self._arm()

    def ensure_armed(self) -> None:
        """Be called in time, if no call was asked for yet."""
        if self._armed_deadline is None:
            self._arm()

    def rearm_if_earlier(self, due: int | None) -> None:
        """Be called in time, if `due` is before the call that was asked for."""
        if due is not None and (self._armed_deadline is None or due < self._armed_deadline):
            self._arm()

    def _arm(self) -> None:
        """Ask to be called at the next deadline, unless an earlier call is already due."""
        due = self._deadline()
        if due is not None and (self._armed_deadline is None or due < self._armed_deadline):
            self._armed_deadline = due
            self._transport.call_at(due, partial(self._on_timer, due))

    def _on_timer(self, due: int) -> None:
        """Do what is due, unless an earlier call has taken the place of this one."""
        if due != self._armed_deadline:
            return
        self._armed_deadline = None
        self._tick(self._transport.now())
        self._on_tick()
        self._arm()
