"""The command process as the bulk process sees it: what it tells, and what it is asked to do."""

import logging
import os
import socket
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import ERROR, Status
from rtron.guard.lanes.bulk.board_writer import BoardWriter
from rtron.guard.lanes.exchange.board import GREETING
from rtron.guard.lanes.exchange.lane_state import LaneState
from rtron.guard.lanes.exchange.process_connection import ProcessConnection
from rtron.guard.link.event_recorder import RecordEvent
from rtron.guard.system.process_port import accept
from rtron.vocabulary import Alarm, EventKind, GuardEventLevel, Settings

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
