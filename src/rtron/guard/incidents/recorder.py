"""The recorder: a process that writes the ring, and saves incidents from it.

It knows the others by its connection to the bulk process. Whatever its disk does, no command waits
for it.
"""

from __future__ import annotations

import logging
import os
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from rtron import __version__
from rtron.errors import RTronError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.incidents.causes import CauseDetector, DueIncident
from rtron.guard.incidents.documents import EntryDocuments
from rtron.guard.incidents.entries import (
    Entry,
    LearnedType,
    NotedEntries,
    RecorderReport,
    RecorderTask,
    RevisionChanged,
    TimedEntry,
)
from rtron.guard.incidents.incident_folder import IncidentFolder, write_incident
from rtron.guard.incidents.ring import IncidentRing
from rtron.guard.lanes.exchange.message_channel import MessageChannel
from rtron.guard.system.process_attributes import lower_priority
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import SECOND, IncidentCause, IncidentHeader, Plan
from rtron.wire.common.incident_format import encode_metadata

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Iterator

log = logging.getLogger(__name__)

RING_SHARE = 8
"""The ring takes one in so many bytes of what the plan allows."""
_NICE = 10
_CHECK_S = 0.25
_RETRY = 2 * SECOND
_SAVE_AGAIN = 5 * SECOND
_SLACK = 5 * SECOND


def machine_wall_offset() -> int:
    """Return what this machine's wall clock is ahead of its steady one now, ns.

    0 if it is behind: MCAP has no time before 1970.
    """
    return max(0, time.time_ns() - time.monotonic_ns())


def run_recorder(sock: socket.socket) -> None:
    """Record what the bulk process sends, until it is gone; what is under way is saved then."""
    lower_priority(_NICE)
    loop = EventLoop()
    process = RecorderProcess(loop, sock)
    loop.run()
    process.close()
    loop.close()


class RecorderProcess:
    """Takes the task, and then the entries."""

    def __init__(self, loop: EventLoop, sock: socket.socket) -> None:
        self._loop = loop
        self._recorder: IncidentRecorder | None = None
        self._last_report: RecorderReport | None = None
        self._channel = MessageChannel(loop, sock, self._take, loop.stop)

    def close(self) -> None:
        """Save what is under way."""
        if self._recorder:
            self._recorder.close(self._loop.now())

    def _take(self, message: object) -> None:
        match message:
            case RecorderTask():
                self._open(message)
            case NotedEntries(entries) if self._recorder:
                self._recorder.add(entries, self._loop.now())

    def _open(self, task: RecorderTask) -> None:
        """Begin, now or as soon as the folder can be used."""
        try:
            self._recorder = IncidentRecorder.open(task)
            problem = "" if self._recorder else "another guard records there"
        except (OSError, RTronError) as error:
            problem = getattr(error, "strerror", None) or str(error)
        if problem:
            self._say(f"{task.folder}: {problem}")
            self._loop.call_at(self._loop.now() + _RETRY, lambda: self._open(task))
        else:
            self._check()

    def _check(self) -> None:
        self._loop.call_later(_CHECK_S, self._check)
        if self._recorder:
            if self._recorder.tick(self._loop.now()):
                self._save_step()
            self._say(self._recorder.problem, self._recorder.saved)

    def _save_step(self) -> None:
        """Write a part of an incident; the entries that wait come in between."""
        if self._recorder and self._recorder.save_step(self._loop.now()):
            self._loop.call_later(0, self._save_step)

    def _say(self, problem: str, saved: str = "") -> None:
        report = RecorderReport(problem, saved)
        if report != self._last_report:
            former = self._last_report.problem if self._last_report else ""
            if problem and problem != former:
                log.error("incidents are not recorded: %s", problem)
            elif former and not problem:
                log.warning("incidents are recorded again")
            self._last_report = report
            self._channel.send(report)


class IncidentRecorder:
    """Writes entries to the ring and saves incidents; disk errors are kept in `problem`.

    The ring has the machine's steady clock, an incident the wall clock as it is when it is saved: a
    robot may learn the time long after its start.
    """

    def __init__(
        self, task: RecorderTask, folder: IncidentFolder, wall_offset: Callable[[], int]
    ) -> None:
        """`wall_offset` returns what the wall clock is ahead of the steady one, ns."""
        plan, keep = task.plan, task.plan.incidents
        self.problem = ""
        self.saved = ""
        self._plan: Plan = plan
        self._folder = folder
        self._wall_offset = wall_offset
        self._profile = "ros1" if plan.ros == 1 else "ros2"
        self._documents = EntryDocuments(Encoding.ROS1 if plan.ros == 1 else Encoding.CDR)
        self._causes = CauseDetector(keep)
        self._max_bytes = keep.megabytes * 10**6 // RING_SHARE
        self._ring = IncidentRing(
            folder.ring,
            span=keep.keep + max(keep.after, self._causes.gap) + _SLACK,
            max_bytes=self._max_bytes,
            profile=self._profile,
        )
        self._settings, self._revision = task.settings, plan.revision
        self._former_settings = ""
        self._retry_at = self._save_again_at = 0
        self._due: DueIncident | None = None
        self._saving: Iterator[None] | None = None

    @classmethod
    def open(
        cls, task: RecorderTask, wall_offset: Callable[[], int] = machine_wall_offset
    ) -> IncidentRecorder | None:
        """Return one that writes to the task's folder; None if another has it.

        OSError or SourceError if it cannot be used.
        """
        total = task.plan.incidents.megabytes * 10**6
        folder = IncidentFolder(Path(task.folder), total - total // RING_SHARE)
        try:
            is_locked = folder.lock()
        except (OSError, RTronError):
            folder.close()
            raise
        if not is_locked:
            folder.close()
            return None
        return cls(task, folder, wall_offset)

    def add(self, entries: tuple[Entry, ...], now: int) -> None:
        """Write entries at `now` (ns, steady), and look whether one is a cause."""
        for entry in entries:
            if isinstance(entry, LearnedType):
                self._documents.learn(entry)
                continue
            if isinstance(entry, RevisionChanged):
                self._take_settings(entry)
            self._causes.note(entry)
            self._write(entry, now)
        self._flush(now)

    def tick(self, now: int) -> bool:
        """Return whether there is an incident to save from now (ns, steady) on, step by step."""
        if self._saving or now < self._save_again_at:
            return False
        if self._due is None:
            self._due = self._causes.take_due(now)
        if self._due:
            self._saving = self._save(self._due)
        return self._due is not None

    def save_step(self, now: int) -> bool:
        """Write a part of the incident; return whether there is more.

        What the disk refuses is tried again, as long as the ring has some of it.
        """
        try:
            if self._saving:
                next(self._saving)
                return True
        except StopIteration:
            self._due = None
        except OSError as error:
            log.error("an incident cannot be saved: %s", error.strerror or error)  # noqa: TRY400
            self._save_again_at = now + _SAVE_AGAIN
            if self._due and now - self._due.end > self._plan.incidents.keep:
                self._due = None
        self._saving = None
        return False

    def close(self, now: int) -> None:
        """Save what has begun until `now` (ns, steady), and finish the ring."""
        self._finish_saving(now)
        while self._begin_last(now) and self._finish_saving(now):
            pass
        with suppress(OSError):
            self._ring.close()
        self._folder.close()

    def _begin_last(self, now: int) -> bool:
        self._due = self._due or self._causes.take_due(now, at_once=True)
        if self._due:
            self._saving = self._save(self._due)
        return self._due is not None

    def _finish_saving(self, now: int) -> bool:
        """Save what is being saved; return whether the disk took it."""
        while self.save_step(now):
            pass
        return self._due is None

    def _take_settings(self, entry: RevisionChanged) -> None:
        if entry.settings != self._settings:
            self._former_settings = self._settings
            self._settings = entry.settings
        self._revision = entry.revision

    def _write(self, entry: TimedEntry, now: int) -> None:
        if now < self._retry_at:
            return
        try:
            for channel, data in self._documents.of(entry):
                self._ring.add(channel, entry.at, data)
        except OSError as error:
            self._fail(error, now)

    def _flush(self, now: int) -> None:
        try:
            self._ring.flush()
        except OSError as error:
            self._fail(error, now)
        else:
            if now >= self._retry_at:
                self.problem = ""

    def _fail(self, error: OSError, now: int) -> None:
        """Write nothing for a while: a full disk costs nobody but the recorder anything."""
        self.problem = f"{self._folder.ring}: {error.strerror or error}"
        self._retry_at = now + _RETRY

    def _save(self, due: DueIncident) -> Iterator[None]:
        offset = self._wall_offset()
        header = self._header(due, offset)
        cause = header.gravest
        log.info("an incident is saved: %s: %s %s", cause.kind, cause.topic, cause.reason)
        self._folder.make_room(self._max_bytes)
        target = self._folder.new_path(header.causes[0].at, cause.kind, cause.topic)
        metadata = encode_metadata(header, self._plan, self._settings, self._former_settings)
        span = due.begin, due.end, offset
        yield from write_incident(self._ring.paths(), target, span, metadata, self._profile)
        self.saved = target.name
        log.warning("incident saved: %s", target)
        self._folder.make_room(0)

    def _header(self, due: DueIncident, offset: int) -> IncidentHeader:
        causes = (each._replace(at=each.at + offset)._asdict() for each in due.causes)
        return IncidentHeader(
            causes=tuple(IncidentCause(**each) for each in causes),
            omitted_causes=due.omitted,
            begin=due.begin + offset,
            end=due.end + offset,
            app=self._plan.app,
            ros=1 if self._plan.ros == 1 else 2,
            revision=self._revision,
            rtron=__version__,
            distribution=os.environ.get("ROS_DISTRO", ""),
        )
