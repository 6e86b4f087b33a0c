"""The command process as the bulk process sees it: what it tells, and what it is asked to do."""

import logging
import os
import socket
from collections import deque
from collections.abc import Callable
from contextlib import suppress

from rtron.errors import SourceError
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import ERROR, Status
from rtron.guard.core.unix_socket import peer_credentials
from rtron.guard.lanes.board_writer import BoardWriter
from rtron.guard.lanes.channel import MessageChannel, bulk_address
from rtron.guard.lanes.lane_state import LaneState
from rtron.guard.lanes.messages import (
    AlarmChange,
    ApplySettings,
    BoardChanged,
    Figures,
    HoldStream,
    NewListener,
    NodesReport,
    RecordedEvent,
    RegisterNode,
    ReleaseStream,
    RepeatStop,
    SettingsAnswer,
    ShutdownRequest,
    StateChange,
    StatusReport,
)
from rtron.guard.link.event_recorder import RecordEvent
from rtron.vocabulary import Settings

log = logging.getLogger(__name__)

GREETING = b"B"
_PAUSE_S = 0.5
_MAX_FORMER = 8


class CommandLane:
    """Serves the command process that has connected last; without one, nothing moves the robot."""

    def __init__(self, loop: EventLoop, master: str, writer: BoardWriter, alarms: Alarms) -> None:
        """SourceError if the guard on `master` has another bulk process."""
        self.state = LaneState()
        self.nodes = NodesReport()
        self.former_uris: frozenset[str] = frozenset()
        """The URIs that the nodes of the command process before had (ROS 1)."""
        self.on_first_report: Callable[[], None] = _do_nothing
        self.on_subscriber: Callable[[str, str], None] = lambda topic, node: None
        self.on_shutdown_request: Callable[[str, str], None] = lambda node, reason: None
        self._loop = loop
        self._writer = writer
        self._alarms = alarms
        self._alarms_there: set[AlarmChange] = set()
        self._statuses: tuple[Status, ...] = ()
        self._figures: dict[str, dict[str, object]] = {}
        self._former_participants: deque[bytes] = deque(maxlen=_MAX_FORMER)
        self._held: dict[str, str] = {}
        self._settings: Settings | None = None
        self._on_answer: Callable[[str], None] = _ignore
        self._record: RecordEvent | None = None
        self._on_change: Callable[[], None] = lambda: None
        self._channel: MessageChannel | None = None
        self._server = _bind(master)

    @property
    def is_connected(self) -> bool:
        """Whether a command process is there."""
        return self._channel is not None

    def open(self) -> None:
        """Let the command process connect from now on."""
        self._writer.on_event_change = lambda: self._send(BoardChanged())
        pause = self._loop.suspend
        self._loop.watch(self._server, self._accept, lambda _: pause(self._server, _PAUSE_S))

    def close(self) -> None:
        """Let go of it."""
        self._loop.forget(self._server)
        if self._channel:
            self._channel.close()

    def statuses(self) -> list[Status]:
        """Return the state of its streams and rules, as it told last."""
        if self._channel is None:
            text = "the command process is not connected: nothing that moves the robot passes"
            return [Status(ERROR, "rtron: command process", text, {})]
        return list(self._statuses)

    def participants(self) -> frozenset[bytes]:
        """Return its participant in the graph of ROS 2, and those of the ones before it."""
        return frozenset(filter(None, (self.nodes.participant, *self._former_participants)))

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
        self._send(ApplySettings(settings))

    def hold(self, topic: str, why: str) -> None:
        """Let nothing of a stream pass and keep the robot stopped."""
        self._held[topic] = why
        self._send(HoldStream(topic, why))

    def release(self, topic: str) -> None:
        """Let pass again what the policies let pass."""
        self._held.pop(topic, None)
        self._send(ReleaseStream(topic))

    def repeat_stop(self, topic: str) -> None:
        """Tell a stop to a node that has just begun to listen."""
        self._send(RepeatStop(topic))

    def register_node(self, name: str) -> None:
        """Register one of its nodes again (ROS 1)."""
        self._send(RegisterNode(name))

    def _send(self, message: object) -> None:
        if self._channel:
            self._channel.send(message)

    def _accept(self) -> None:
        sock, _ = self._server.accept()
        if peer_credentials(sock)[1] != os.getuid():
            sock.close()
            return
        if self._channel:
            self._channel.close()
        with suppress(OSError):  # it has ended at once, which the channel sees
            socket.send_fds(sock, [GREETING], [self._writer.board.descriptor])
        self._channel = MessageChannel(self._loop, sock, self._on_message, self._on_lost)
        for topic, why in self._held.items():
            self._send(HoldStream(topic, why))
        if self._settings:
            self._send(ApplySettings(self._settings))

    def _on_lost(self) -> None:
        log.warning("the command process is gone")
        self._channel = None
        self.former_uris = frozenset(self.nodes.uris.values())
        self._former_participants.append(self.nodes.participant)
        self.nodes, self.state = NodesReport(), LaneState()
        for change in self._alarms_there:
            self._alarms.mirror(change.alarm, self._loop.now(), active=False)
        self._alarms_there.clear()

    def _on_message(self, message: object) -> None:
        match message:
            case StatusReport(statuses, nodes):
                self._statuses, self.nodes = statuses, nodes
                on_first_report, self.on_first_report = self.on_first_report, _do_nothing
                on_first_report()
            case StateChange(state):
                self.state = state
                self._on_change()
            case Figures(by_topic):
                self._figures |= {topic: dict(found) for topic, found in by_topic.items()}
            case RecordedEvent():
                self._record_event(message)
            case AlarmChange():
                self._mirror_alarm(message)
            case NewListener(topic, node):
                self.on_subscriber(topic, node)
            case ShutdownRequest(node, reason):
                self.on_shutdown_request(node, reason)
            case SettingsAnswer():
                self._take_answer(message)

    def _record_event(self, message: RecordedEvent) -> None:
        if self._record:
            self._record(message.kind, message.level, **message.values)

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


def _bind(master: str) -> socket.socket:
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        sock.bind(bulk_address(master))
    except OSError:
        sock.close()
        message = f"the guard on {master} has a bulk process already"
        raise SourceError(message, help="it ends soon after its guard") from None
    sock.listen()
    sock.settimeout(0)
    return sock


def _do_nothing() -> None:
    """Do nothing."""


def _ignore(_error: str) -> None:
    """Do nothing about an answer."""
