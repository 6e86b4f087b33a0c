"""What the command process knows of frames and events: what stands on the bulk process's board."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rtron.guard.core.observations import Observations, observations_of
from rtron.guard.lanes.board import STALE_AFTER, Board, RateRecord
from rtron.policies.mission.event_bits import EventState
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.policies.velocity_limit.frame_monitors import FrameMonitor, FrameRateReport
from rtron.vocabulary import SECOND, FpsMonitor, Plan


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

    @property
    def written_at(self) -> int:
        """When the board was last written (ns), 0 without a board."""
        return self._board.written_at if self._board else 0

    def replace(self, board: Board | None) -> None:
        """Look at another board, or at none."""
        if self._board:
            self._board.close()
        self._board = board


class BoardObservations:
    """Keeps a mission's bits as they stand on the board."""

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

    def connect(self, board: Board | None, now: int) -> None:
        """Look at another bulk process's board; what it has heard until now counts for no rule."""
        self.view.replace(board)
        bits = self._mission.bits.by_name
        for index, flow in enumerate(self._flows):
            bits[flow].restore(self.view.event(index, now) or EventState())
        self._mission.update(now)

    def update(self, now: int) -> None:
        """Look at the events again: they may have changed, or be stale."""
        bits = self._mission.bits.by_name
        for index, flow in enumerate(self._flows):
            nobody = EventState(true_count=bits[flow].state.true_count)
            self._mission.restore(flow, self.view.event(index, now) or nobody)
        self._mission.update(now)

    @property
    def _mission(self) -> MissionMonitor:
        return self.observations.mission
