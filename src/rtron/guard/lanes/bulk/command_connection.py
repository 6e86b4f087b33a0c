"""The command process as the bulk process sees it: what it tells, and what it is asked to do."""

import logging
import os
import socket
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import Observations
from rtron.guard.core.report_messages import ERROR, Status
from rtron.guard.core.timers import DelayedCall
from rtron.guard.lanes.exchange.board import (
    GREETING,
    REFRESH_PERIOD,
    Board,
    EventRecord,
    RateRecord,
)
from rtron.guard.lanes.exchange.lane_state import LaneState
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.guard.link.event_recorder import RecordEvent
from rtron.guard.system.process_port import accept
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.policies.mission.event_bits import EventBit, EventState
from rtron.vocabulary import SECOND, Alarm, EventKind, GuardEventLevel, Settings

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


log = logging.getLogger(__name__)
_PAUSE_S = 0.5


class CommandConnection(ProcessConnection):
    """Serves the command process that has connected last; without one, nothing moves the robot."""

    def __init__(
        self,
        loop: EventLoop,
        port: socket.socket,
        configuration: bytes,
        writer: BoardWriter,
        alarms: Alarms,
    ) -> None:
        """`port` is the accepting side: command processes with this configuration are served."""
        super().__init__(loop)
        self.state = LaneState()
        self._writer = writer
        self._alarms = alarms
        self._alarms_there: set[Alarm] = set()
        self._statuses: tuple[Status, ...] = ()
        self._figures: dict[str, dict[str, object]] = {}
        self._settings: Settings | None = None
        self._on_answer: Callable[[str], None] = _ignore
        self._record: RecordEvent | None = None
        self._on_change: Callable[[], None] = lambda: None
        self._port, self._configuration = port, configuration
        self.on(
            statuses=self._take_statuses,
            state=self._take_state,
            figures=self._take_figures,
            event=self._record_event,
            alarm=self._mirror_alarm,
            settings_answer=self._take_answer,
        )

    def open(self) -> None:
        """Let the command process connect from now on."""
        self._writer.on_event_change = lambda: self.call("board_changed")
        pause = self._loop.suspend
        self._loop.watch(self._port, self._accept, lambda _: pause(self._port, _PAUSE_S))

    def close(self) -> None:
        """Let go of it."""
        self._loop.forget(self._port)
        if self._channel:
            self._channel.close()

    def statuses(self) -> list[Status]:
        """Return the state of its streams and rules, as it told last."""
        if self._channel is None:
            text = "the command process is not connected: nothing that moves the robot passes"
            return [Status(ERROR, "rtron: command process", text, {})]
        return list(self._statuses)

    def take_figures(self) -> dict[str, dict[str, object]]:
        """Return what became of the messages since the last call, by topic."""
        figures, self._figures = self._figures, {}
        return figures

    def listen(self, record: RecordEvent, on_change: Callable[[], None]) -> None:
        """Record what happens there, and call `on_change` when the state is another."""
        self._record, self._on_change = record, on_change

    def apply(self, settings: Settings, on_answer: Callable[[str], None]) -> None:
        """Put settings in force there, at the latest when it connects again."""
        self._settings, self._on_answer = settings, on_answer
        self.call("apply_settings", settings)

    def _accept(self) -> None:
        accepted = accept(self._port)
        if accepted is None:
            return
        sock, configuration = accepted
        if configuration != self._configuration:
            sock.close()
            return
        if self._channel:
            self._channel.close()
        with suppress(OSError):  # it has ended at once, which the channel sees
            socket.send_fds(sock, [GREETING.pack(os.getpid())], [self._writer.board.descriptor])
        self._open_channel(sock)
        if self._settings:
            self.call("apply_settings", self._settings)
        for listener in self.connect_listeners:
            listener()

    def _on_lost(self) -> None:
        log.warning("the command process is gone")
        self.state = LaneState()
        for alarm in self._alarms_there:
            self._alarms.mirror(alarm, self._loop.now(), active=False)
        self._alarms_there.clear()
        super()._on_lost()

    def _take_statuses(self, statuses: tuple[Status, ...]) -> None:
        self._statuses = statuses

    def _take_state(self, state: LaneState) -> None:
        self.state = state
        self._on_change()

    def _take_figures(self, by_topic: Mapping[str, Mapping[str, object]]) -> None:
        self._figures |= {topic: dict(found) for topic, found in by_topic.items()}

    def _record_event(
        self, at: int, kind: EventKind, level: GuardEventLevel, values: Mapping[str, Any]
    ) -> None:
        if self._record:
            self._record(kind, level, at=at, **values)

    def _mirror_alarm(self, alarm: Alarm, active: bool) -> None:  # noqa: FBT001 - a call's argument
        change = self._alarms_there.add if active else self._alarms_there.discard
        change(alarm)
        self._alarms.mirror(alarm, self._loop.now(), active=active)

    def _take_answer(self, revision: int, error: str) -> None:
        if self._settings and revision == self._settings.revision:
            on_answer, self._on_answer = self._on_answer, _ignore
            on_answer(error)


def _ignore(_error: str) -> None:
    """Do nothing."""
