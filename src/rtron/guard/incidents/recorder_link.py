"""The bulk process's side of the recorder: it hands on what both lanes note."""

import logging
import socket
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import OK, WARN, Status
from rtron.guard.incidents.entries import (
    AlarmSwitched,
    Entry,
    EntryBuffer,
    LearnedType,
    NotedEntries,
    Observed,
    Received,
    RecorderReport,
    RecorderTask,
    RevisionChanged,
    Sent,
)
from rtron.guard.incidents.stream_notes import StreamNotes, observed_state
from rtron.guard.incidents.stream_tap import is_due
from rtron.guard.lanes.exchange.message_channel import MessageChannel
from rtron.guard.system.process_port import connect
from rtron.vocabulary import SECOND, Alarm, Plan, Settings
from rtron.wire.common.incident_format import encode_settings

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.settings.in_force import SettingsInForce

log = logging.getLogger(__name__)

MAX_WAITING_BYTES = 1 << 22
"""What may wait for a recorder that writes to a slow disk, bytes."""
_BATCH_BYTES = 1 << 19
_SEND_PERIOD = SECOND // 20
_RETRY = 2 * SECOND
_SLOW = 10 * SECOND
"""After which a recorder that reads nothing is said, ns."""


class RecorderLink:
    """Connects to the recorder, again when it ends, and sends it entries 20 times a second."""

    def __init__(
        self,
        plan: Plan,
        folder: Path,
        port: socket.socket,
        host: Coordinator,
        loop: EventLoop,
        settings: "SettingsInForce | None" = None,
    ) -> None:
        """`port` is the connecting side of the recorder's port.

        `host` carries the streams of the bulk process, and knows the alarms of both.
        """
        self._plan = plan
        self._folder = folder
        self._port = port
        self._host = host
        self._loop = loop
        self._settings = settings
        self._own = StreamNotes(host, loop.now, MAX_WAITING_BYTES)
        self._others = EntryBuffer(MAX_WAITING_BYTES)
        self._types: dict[str, LearnedType] = {}
        self._channel: MessageChannel | None = None
        self._report = RecorderReport("", "")
        self.on_saved: Callable[[str], None] = lambda name: None
        """Called with the name of the file of each incident."""
        self._observed: Observed | None = None
        self._revision: int | None = None
        self._read_at = loop.now()
        self._is_answered = self._is_closed = False

    def open(self) -> None:
        """Tell the recorder what happens from now on."""
        self._own.open()
        self._follow_alarms()
        self._connect()
        self._send()

    def close(self) -> None:
        """Send what is left; the recorder saves what is under way, and ends."""
        self._is_closed = True
        self._send_batches()
        if self._channel:
            self._channel.close()

    def receive(self, entries: tuple[Entry, ...]) -> None:
        """Take what the command process has noted."""
        for entry in entries:
            size = len(entry.message) if isinstance(entry, Received | Sent) else 0
            self._others.add(entry, size)

    def statuses(self) -> list[Status]:
        """Return why incidents are not recorded, or which was saved last, if there is any."""
        problem, saved = self._report
        if self._channel and self._loop.now() - self._read_at > _SLOW:
            problem = "the recorder reads nothing, its disk may hang"
        if not (problem or saved):
            return []
        values = {"last incident": saved} if saved else {}
        text = f"not recorded: {problem}" if problem else "recorded"
        return [Status(WARN if problem else OK, "rtron: incidents", text, values)]

    def _connect(self) -> None:
        """Tell the next recorder what the one before knew."""
        if self._is_closed:
            return
        self._is_answered = False
        try:
            connection = connect(self._port)
        except OSError as error:
            self._note(RecorderReport(f"the recorder is not reached: {error}", ""))
            self._loop.call_at(self._loop.now() + _RETRY, self._connect)
            return
        self._report = RecorderReport("", self._report.saved)
        self._channel = MessageChannel(self._loop, connection, self._take, self._on_lost)
        self._channel.send(RecorderTask(self._plan, self._settings_text(), str(self._folder)))
        self._channel.send(NotedEntries(tuple(self._types.values())))

    def _settings_text(self) -> str:
        return encode_settings(self._settings.current if self._settings else Settings())

    def _take(self, message: object) -> None:
        if isinstance(message, RecorderReport):
            self._is_answered = True
            if message.saved not in ("", self._report.saved):
                self.on_saved(message.saved)
            self._note(message)

    def _note(self, report: RecorderReport) -> None:
        self._report = report._replace(saved=report.saved or self._report.saved)

    def _on_lost(self) -> None:
        self._channel = None
        if not self._is_closed:
            log.error("the recorder of incidents is gone; the next one goes on")
            self._connect()

    def _send(self) -> None:
        self._loop.call_at(self._loop.now() + _SEND_PERIOD, self._send)
        self._observe()
        self._send_batches()

    def _send_batches(self) -> None:
        """Send what both lanes have noted, if the recorder has read what it got before."""
        if self._channel is None or self._channel.has_pending:
            return
        now = self._loop.now()
        if self._is_answered:
            self._read_at = now
        entries = [*self._own.take(_BATCH_BYTES), *self._others.take(_BATCH_BYTES, now)]
        if entries:
            self._types |= {each.topic: each for each in entries if isinstance(each, LearnedType)}
            self._channel.send(NotedEntries(tuple(entries)))

    def _observe(self) -> None:
        """Note the frame rates, events and settings, where they have changed."""
        now = self._loop.now()
        observed = observed_state(self._host.observations, now)
        last = self._observed
        if last is None or observed[1:] != last[1:] or is_due(last.at, now):
            self._observed = observed
            if observed.rates or observed.events:
                self._own.buffer.add(observed)
        self._note_revision(now)

    def _note_revision(self, now: int) -> None:
        revision = self._settings.revision if self._settings else self._plan.revision
        if revision != self._revision:
            self._revision = revision
            self._own.buffer.add(RevisionChanged(now, revision, self._settings_text()))

    def _follow_alarms(self) -> None:
        """Note the alarms, too, first those that stand already."""
        former = self._host.alarms.listener

        def listen(alarm: Alarm, *, active: bool) -> None:
            former(alarm, active=active)
            self._note_alarm(alarm, active=active)

        self._host.alarms.listener = listen
        for alarm in self._host.alarms.active:
            self._note_alarm(alarm, active=True)

    def _note_alarm(self, alarm: Alarm, *, active: bool) -> None:
        entry = AlarmSwitched(self._loop.now(), alarm.kind, alarm.topic, alarm.reason, active)
        self._own.buffer.add(entry)
