"""What the command process knows of frames and events: what stands on the bulk process's board."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rtron.guard.core.observations import Observations, observations_of
from rtron.guard.lanes.exchange.board import STALE_AFTER, Board, RateRecord
from rtron.policies.mission.event_bits import EventState
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.policies.velocity_limit.frame_monitors import FrameMonitor, FrameRateReport
from rtron.vocabulary import SECOND, FpsMonitor, Plan

_RECONNECTED_WITHIN = 5 * SECOND
"""How long a bulk process may take to hear again what the one before has heard, ns."""


class BoardMonitor(FrameMonitor):
    """One fps_monitor whose frames another process counts."""

    __slots__ = ("_record",)

    def __init__(self, plan: FpsMonitor, record: Callable[[], RateRecord | None]) -> None:
        super().__init__(plan)
        self._record = record

    def rate(self, now: int) -> FrameRateReport:
        """Return the rate at `now`, silent where the number is stale."""
        record = self._record()
        if record is None or not record.last_frame_at or now >= self._silent_at(record):
            return FrameRateReport(self.id, 0.0, None)
        age = max(0, now - record.last_frame_at)
        return FrameRateReport(self.id, min(record.fps, SECOND / age) if age else record.fps, age)

    def silence_deadline(self) -> int | None:
        """Return when the image node counts as silent if nothing more is written."""
        record = self._record()
        return self._silent_at(record) if record else None

    def _silent_at(self, record: RateRecord) -> int:
        return min(record.last_frame_at + self._silent_after, record.written_at + STALE_AFTER)


class BoardView:
    """The board of the bulk process that is connected, if one is."""

    def __init__(self) -> None:
        self._board: Board | None = None

    def rate(self, index: int) -> RateRecord | None:
        """Return the record of an fps_monitor; None if there is none."""
        return self._board.rate(index) if self._board else None

    def event(self, index: int, now: int) -> EventState | None:
        """Return what is known of an eflow at `now`; None if there is nothing, or it is stale."""
        record = self._board.event(index) if self._board else None
        return record.state if record and now - record.written_at < STALE_AFTER else None

    def replace(self, board: Board | None) -> None:
        """Look at another board, or at none."""
        if self._board:
            self._board.close()
        self._board = board


class BoardObservations:
    """Keeps a mission's bits as they stand on the board; a bit that is stale there is not known."""

    def __init__(self, plan: Plan) -> None:
        self.view = BoardView()
        planned = observations_of(plan)
        for index, monitor in enumerate(plan.fps_monitor):
            planned.rates.monitors[monitor.id] = BoardMonitor(
                monitor, partial(self.view.rate, index)
            )
        self.observations: Observations = replace(planned, monitors=(), events=())
        """What the policies of the command process depend on; it subscribes to nothing."""
        self._flows = [flow.name for flow in plan.msrcn.eflows] if plan.msrcn else []
        self._before: dict[str, EventState] = {}
        self._connected_at = 0
        self.connect(None, 0)

    def connect(self, board: Board | None, now: int) -> None:
        """Look at another bulk process's board, or at none.

        What the process before has heard goes on for a moment, until this one has heard something.
        """
        self.view.replace(board)
        self._connected_at = now
        bits = self._mission.bits.by_name
        self._before = {flow: bits[flow].state for flow in self._flows}
        for index, flow in enumerate(self._flows):
            found = self.view.event(index, now)
            bits[flow].restore(self._continued(flow, found or EventState(), now))
        self.update(now)

    def update(self, now: int) -> None:
        """Look at the events again: they may have changed, or be stale."""
        for index, flow in enumerate(self._flows):
            if found := self.view.event(index, now):
                self._mission.restore(flow, self._continued(flow, found, now))
            else:
                self._mission.bits.by_name[flow].forget()
        self._mission.update(now)

    def _continued(self, flow: str, found: EventState, now: int) -> EventState:
        """Return what is known of an eflow, with what the process before has heard of it."""
        before = self._before[flow]
        times = [each for each in (found.triggered, before.triggered) if each is not None]
        found = found._replace(triggered=max(times, default=None))
        if found.newest is not None:
            self._before[flow] = EventState(triggered=before.triggered)
        elif before.newest is not None and now - self._connected_at < _RECONNECTED_WITHIN:
            publishers = max(found.publishers, before.publishers)
            found = found._replace(
                publishers=publishers, newest=before.newest, judged=before.judged
            )
        return found

    @property
    def _mission(self) -> MissionMonitor:
        return self.observations.mission
