"""The command process as the bulk process sees it: what it tells, and what it is asked to do."""

import logging
import os
import socket
from collections.abc import Callable
from contextlib import suppress

from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import ERROR, Status
from rtron.guard.lanes.bulk.board_writer import BoardWriter
from rtron.guard.lanes.exchange.board import GREETING
from rtron.guard.lanes.exchange.lane_state import LaneState
from rtron.guard.lanes.exchange.message_channel import MessageChannel
from rtron.guard.lanes.exchange.messages import (
    AlarmChange,
    ApplySettings,
    BoardChanged,
    Figures,
    RecordedEvent,
    SettingsAnswer,
    StateChange,
    StatusReport,
)
from rtron.guard.link.event_recorder import RecordEvent
from rtron.guard.system.process_port import accept
from rtron.vocabulary import Settings

log = logging.getLogger(__name__)

_PAUSE_S = 0.5


class CommandConnection:
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
        self.state = LaneState()
        self.message_listeners: list[Callable[[object], None]] = []
        """Each takes every message of the command process that is not for the connection itself."""
        self.connect_listeners: list[Callable[[], None]] = []
        self.loss_listeners: list[Callable[[], None]] = []
        self._loop = loop
        self._writer = writer
        self._alarms = alarms
        self._alarms_there: set[AlarmChange] = set()
        self._statuses: tuple[Status, ...] = ()
        self._figures: dict[str, dict[str, object]] = {}
        self._settings: Settings | None = None
        self._on_answer: Callable[[str], None] = _ignore
        self._record: RecordEvent | None = None
        self._on_change: Callable[[], None] = lambda: None
        self._channel: MessageChannel | None = None
        self._port, self._configuration = port, configuration

    @property
    def is_connected(self) -> bool:
        """Whether a command process is there."""
        return self._channel is not None

    def open(self) -> None:
        """Let the command process connect from now on."""
        self._writer.on_event_change = lambda: self.send(BoardChanged())
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
        self.send(ApplySettings(settings))

    def send(self, message: object) -> None:
        """Tell something; without a command process it is lost."""
        if self._channel:
            self._channel.send(message)

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
        self._channel = MessageChannel(self._loop, sock, self._on_message, self._on_lost)
        if self._settings:
            self.send(ApplySettings(self._settings))
        for listener in self.connect_listeners:
            listener()

    def _on_lost(self) -> None:
        log.warning("the command process is gone")
        self._channel = None
        self.state = LaneState()
        for change in self._alarms_there:
            self._alarms.mirror(change.alarm, self._loop.now(), active=False)
        self._alarms_there.clear()
        for listener in self.loss_listeners:
            listener()

    def _on_message(self, message: object) -> None:
        match message:
            case StatusReport(statuses):
                self._statuses = statuses
            case StateChange(state):
                self.state = state
                self._on_change()
            case Figures(by_topic):
                self._figures |= {topic: dict(found) for topic, found in by_topic.items()}
            case RecordedEvent():
                self._record_event(message)
            case AlarmChange():
                self._mirror_alarm(message)
            case SettingsAnswer():
                self._take_answer(message)
            case _:
                for listener in self.message_listeners:
                    listener(message)

    def _record_event(self, message: RecordedEvent) -> None:
        if self._record:
            self._record(message.kind, message.level, at=message.at, **message.values)

    def _mirror_alarm(self, change: AlarmChange) -> None:
        raised = AlarmChange(change.alarm, active=True)
        if change.active:
            self._alarms_there.add(raised)
        else:
            self._alarms_there.discard(raised)
        self._alarms.mirror(change.alarm, self._loop.now(), active=change.active)

    def _take_answer(self, answer: SettingsAnswer) -> None:
        if self._settings and answer.revision == self._settings.revision:
            on_answer, self._on_answer = self._on_answer, _ignore
            on_answer(answer.error)


def _ignore(_message: object) -> None:
    """Do nothing."""
