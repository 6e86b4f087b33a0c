"""Writes what the bulk process observes to the board."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import Observations
from rtron.guard.core.timers import DelayedCall
from rtron.guard.lanes.exchange.board import REFRESH_PERIOD, Board, EventRecord, RateRecord
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.policies.mission.event_bits import EventBit, EventState
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from rtron.policies.velocity_limit.frame_monitors import FrameMonitor


NOTICE_PERIOD = SECOND // 200
"""The least time between two notices that events have changed, ns."""


class BoardWriter:
    """Keeps a board up to date with observations, from `open` on."""

    def __init__(self, observations: Observations, loop: EventLoop, beat: SharedBeat) -> None:
        """`beat` shows the supervisor that the board is written."""
        self._monitors: list[FrameMonitor] = list(observations.rates.monitors.values())
        self._bits: list[EventBit] = list(observations.mission.bits.by_name.values())
        self._loop, self._beat = loop, beat
        self.board = Board.create(len(self._monitors), len(self._bits))
        self.on_event_change: Callable[[], None] = lambda: None
        """Called when the records of events have changed."""
        self._states: list[EventState] = []
        self._notice = DelayedCall(loop, NOTICE_PERIOD, lambda: self.on_event_change())  # noqa: PLW0108 - set later

    def open(self) -> None:
        """Write each number now, and again before it is stale."""
        self._loop.call_at(self._loop.now() + REFRESH_PERIOD, self.open)
        self.refresh()

    def refresh(self) -> None:
        """Write each number as it is now."""
        now = self._loop.now()
        for index, monitor in enumerate(self._monitors):
            rate = monitor.rate(now)
            last_frame_at = 0 if rate.age is None else now - rate.age
            self.board.write_rate(index, RateRecord(rate.fps, last_frame_at, now))
        states = [bit.state for bit in self._bits]
        self._write_events(states, now)
        self._beat.at = now
        if states != self._states:
            self._states = states
            self._notice.schedule()  # an event that comes often costs the other side little

    def close(self) -> None:
        """Write no more."""
        self.board.close()

    def _write_events(self, states: Iterable[EventState], now: int) -> None:
        for index, state in enumerate(states):
            self.board.write_event(index, EventRecord(state, now))
