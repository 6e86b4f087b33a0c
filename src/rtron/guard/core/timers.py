"""Timers: one for a deadline that moves, one for calls that follow each other too fast."""

from collections.abc import Callable
from functools import partial
from typing import Protocol


class Scheduler(Protocol):
    """A clock (ns) that calls back: an event loop, or a transport."""

    def now(self) -> int:
        """Return the time, ns."""
        ...

    def call_at(self, when: int, callback: Callable[[], None], /) -> None:
        """Call back once at `when` (ns)."""
        ...


class DeadlineTimer:
    """Calls `tick(now)` when `deadline()` (ns) has come, and `on_tick` after it.

    The scheduler may hold several calls; only the earliest counts.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        deadline: Callable[[], int | None],
        tick: Callable[[int], None],
        on_tick: Callable[[], None],
    ) -> None:
        self._scheduler = scheduler
        self._deadline = deadline
        self._tick = tick
        self._on_tick = on_tick
        self._armed_deadline: int | None = None

    def run_due(self, now: int) -> None:
        """Tick if that is due, and arm the timer for the next deadline."""
        due = self._deadline()
        if due is not None and due <= now:
            self._tick(now)
        self.arm()

    def ensure_armed(self) -> None:
        """Arm the timer if it is not armed."""
        if self._armed_deadline is None:
            self.arm()

    def rearm_if_earlier(self, due: int | None) -> None:
        """Arm the timer again if `due` (ns) is before the deadline it is armed for."""
        if due is not None and (self._armed_deadline is None or due < self._armed_deadline):
            self.arm()

    def arm(self) -> None:
        """Ask for a call at the next deadline, unless an earlier call comes anyway."""
        due = self._deadline()
        if due is not None and (self._armed_deadline is None or due < self._armed_deadline):
            self._armed_deadline = due
            self._scheduler.call_at(due, partial(self._on_timer, due))

    def _on_timer(self, due: int) -> None:
        """Tick, unless an earlier call has replaced this one."""
        if due != self._armed_deadline:
            return
        self._armed_deadline = None
        self._tick(self._scheduler.now())
        self._on_tick()
        self.arm()


class DelayedCall:
    """Calls a function after the event in which it is asked for, `delay` ns after the last call.

    So the first change counts at once, and many that follow cost one call.
    """

    def __init__(self, scheduler: Scheduler, delay: int, function: Callable[[], None]) -> None:
        self._scheduler = scheduler
        self._delay = delay
        self._function = function
        self._is_scheduled = False
        self._called_at = -delay

    def schedule(self) -> None:
        """Call it as soon as it may be called."""
        if not self._is_scheduled:
            self._is_scheduled = True
            due = max(self._scheduler.now(), self._called_at + self._delay)
            self._scheduler.call_at(due, self._run)

    def _run(self) -> None:
        self._is_scheduled = False
        self._called_at = self._scheduler.now()
        self._function()
