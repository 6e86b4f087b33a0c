"""The bulk process's side of the recorder: it starts it, and hands on what both lanes note."""

import logging
import socket
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.report_messages import OK, WARN, Status
from rtron.guard.incidents.entries import (
    AlarmSwitched,
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
from rtron.guard.supervision.programs import INCIDENTS, start_program
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
_RESTART_AFTER = 2 * SECOND
_LONGEST_RESTART = 60 * SECOND
_STABLE = 10 * SECOND
"""A recorder that lives so long is well, ns; one that ends sooner is started more seldom."""
_END_S = 8.0
"""How long the recorder may take to save what has begun; the supervisor waits 10 s for us."""
_SLOW = 10 * SECOND
"""After which a recorder that reads nothing is said, ns."""


class RecorderLink:
    """Starts the recorder, again when it ends, and sends it entries 20 times a second."""

    def __init__(
        self,
        plan: Plan,
        folder: Path,
        host: Coordinator,
        loop: EventLoop,
        settings: "SettingsInForce | None" = None,
    ) -> None:
        """`host` carries the streams of the bulk process, and knows the alarms of both."""
        self._plan = plan
        self._folder = folder
        self._host = host
        self._loop = loop
        self._settings = settings
        self._own = StreamNotes(host, loop.now, MAX_WAITING_BYTES)
        self._others = EntryBuffer(MAX_WAITING_BYTES)
        self._types: dict[str, LearnedType] = {}
        self._process: subprocess.Popen[bytes] | None = None
        self._channel: MessageChannel | None = None
        self._report = RecorderReport("", "")
        self.on_saved: Callable[[str], None] = lambda name: None
        """Called with the name of the file of each incident."""
        self._observed: Observed | None = None
        self._revision: int | None = None
        self._read_at = loop.now()
        self._started_at, self._restart_delay = 0, _RESTART_AFTER // 2
        self._is_closed = False

    def open(self) -> None:
        """Start the recorder, and tell it what happens from now on."""
        self._own.open()
        self._follow_alarms()
        self._start()
        self._send()

    def close(self) -> None:
        """Send what is left; the recorder saves what is under way, and ends before this process."""
        self._is_closed = True
        self._send_batches()
        if self._channel:
            self._channel.close()
        if self._process:
            self._end(self._process)

    @staticmethod
    def _end(process: subprocess.Popen[bytes]) -> None:
        """Wait for the recorder's end; one whose disk hangs is killed and not waited for."""
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            log.exception("the recorder of incidents does not end: it is killed")
            process.kill()

    def receive(self, message: object) -> None:
        """Take what the command process has noted."""
        if isinstance(message, NotedEntries):
            for entry in message.entries:
                size = len(entry.message) if isinstance(entry, Received | Sent) else 0
                self._others.add(entry, size)

    def statuses(self) -> list[Status]:
        """Return why incidents are not recorded, or which was saved last, if there is any."""
        problem, saved = self._report
        if self._loop.now() - self._read_at > _SLOW:
            problem = "the recorder reads nothing, its disk may hang"
        if not (problem or saved):
            return []
        values = {"last incident": saved} if saved else {}
        text = f"not recorded: {problem}" if problem else "recorded"
        return [Status(WARN if problem else OK, "rtron: incidents", text, values)]

    def _start(self) -> None:
        """Start the recorder, and tell it what the one before knew."""
        if self._is_closed:
            return
        if self._process:
            self._process.poll()
        self._started_at = self._loop.now()
        own, others = socket.socketpair()
        try:
            self._process = start_program(INCIDENTS, [others.fileno()])
        except OSError as error:
            own.close()
            self._on_report(RecorderReport(f"no recorder can be started: {error}", ""))
            self._start_again()
            return
        finally:
            others.close()
        self._report = RecorderReport("", self._report.saved)
        self._channel = MessageChannel(self._loop, own, self._on_report, self._on_lost)
        level = logging.getLogger().getEffectiveLevel()
        self._channel.send(
            RecorderTask(self._plan, self._settings_text(), str(self._folder), level)
        )
        self._channel.send(NotedEntries(tuple(self._types.values())))

    def _settings_text(self) -> str:
        return encode_settings(self._settings.current if self._settings else Settings())

    def _on_report(self, message: object) -> None:
        if isinstance(message, RecorderReport):
            if message.saved not in ("", self._report.saved):
                self.on_saved(message.saved)
            self._report = message._replace(saved=message.saved or self._report.saved)

    def _on_lost(self) -> None:
        self._channel = None
        if not self._is_closed:
            log.error("the recorder of incidents is gone; it is started again")
            self._start_again()

    def _start_again(self) -> None:
        """Start the recorder in a while, which is longer each time that it has ended at once."""
        now = self._loop.now()
        is_well = now - self._started_at > _STABLE
        self._restart_delay = (
            _RESTART_AFTER if is_well else min(2 * self._restart_delay, _LONGEST_RESTART)
        )
        self._loop.call_at(now + self._restart_delay, self._start)

    def _send(self) -> None:
        self._loop.call_at(self._loop.now() + _SEND_PERIOD, self._send)
        self._observe()
        self._send_batches()

    def _send_batches(self) -> None:
        """Send what both lanes have noted, if the recorder has read what it got before."""
        if self._channel is None or self._channel.has_pending:
            return
        self._read_at = now = self._loop.now()
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
