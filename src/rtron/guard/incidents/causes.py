"""When an incident is saved: pure, over what the streams noted and the time that is passed in.

A cause that goes on is one cause: an intruder at 200 Hz makes one incident. Several causes within
`after` of each other are in one incident as well, and two incidents end a while apart.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from rtron.guard.incidents.entries import AlarmSwitched, ControlState, Entry, Received, Sent
from rtron.vocabulary import SECOND, Decision, IncidentRecording

MAX_CAUSES = 20
"""How many causes an incident names."""
IN_FLIGHT = SECOND // 2
"""How long an entry may be on its way to the recorder, ns."""
_MAX_KNOWN = 512
_CHANGING = Decision.DROP, Decision.MODIFY
_NUMBER = re.compile(r"\d+(\.\d+)?")


class Cause(NamedTuple):
    """Why an incident is saved: `kind` is intervention, stop or alarm; `at` is ns, steady."""

    at: int
    kind: str
    topic: str
    flow: str
    reason: str


@dataclass(frozen=True, slots=True)
class DueIncident:
    """An incident to be saved: its causes, the first one first, and what it is about (ns)."""

    causes: tuple[Cause, ...]
    omitted: int
    begin: int
    end: int


@dataclass(slots=True)
class _CauseList:
    """The causes of one incident, the first ones; others are counted."""

    causes: list[Cause] = field(default_factory=list)
    omitted: int = 0

    def add(self, cause: Cause) -> None:
        if len(self.causes) < MAX_CAUSES:
            self.causes.append(cause)
        else:
            self.omitted += 1


class CauseDetector:
    """Collects causes until an incident is due, and those behind its end for the next one."""

    def __init__(self, recording: IncidentRecording) -> None:
        self._keep = recording.keep
        self._after = recording.after
        self.gap = recording.keep // 2
        """The least time between the ends of two incidents, ns."""
        self._seen_at: dict[tuple[str, ...], int] = {}
        self._current, self._next = _CauseList(), _CauseList()
        self._saved_at: int | None = None

    def note(self, entry: Entry) -> None:
        """Look whether an entry is a cause that has not been there for the time that is kept."""
        for key, cause in _causes_in(entry):
            last = self._seen_at.pop(key, None)
            if len(self._seen_at) >= _MAX_KNOWN:
                del self._seen_at[next(iter(self._seen_at))]
            self._seen_at[key] = cause.at
            if last is None or cause.at - last > self._keep:
                is_behind = self._current.causes and cause.at > self._end()
                (self._next if is_behind else self._current).add(cause)

    def take_due(self, now: int, *, at_once: bool = False) -> DueIncident | None:
        """Return the incident that is due at `now` (ns), or that has begun if `at_once`."""
        if not self._current.causes:
            return None
        first, end = self._current.causes[0].at, self._end()
        if now < end + IN_FLIGHT and not at_once:
            return None
        due = DueIncident(
            tuple(self._current.causes),
            self._current.omitted,
            first - self._keep,
            max(first, min(now, end)),
        )
        self._current, self._next, self._saved_at = self._next, _CauseList(), now
        return due

    def _end(self) -> int:
        """Return when the incident that has begun ends, ns."""
        end = self._current.causes[0].at + self._after
        return end if self._saved_at is None else max(end, self._saved_at + self.gap)


def _causes_in(entry: Entry) -> Iterator[tuple[tuple[str, ...], Cause]]:
    """Yield what in an entry is a cause, and by what it is known to go on."""
    match entry:
        case Received(at, topic, flow) if entry.decision in _CHANGING:
            reason = f"{entry.decision}: {entry.reason or entry.policy}"
            cause = Cause(at, "intervention", topic, flow, reason)
            why = _kind_of_reason(entry.reason)
            yield (cause.kind, topic, flow, entry.decision, entry.policy, why), cause
        case Sent() | ControlState() if entry.stopping:
            flow = entry.flow if isinstance(entry, Sent) else entry.owner
            cause = Cause(entry.at, "stop", entry.topic, flow, entry.stopping)
            yield (cause.kind, entry.topic, _kind_of_reason(entry.stopping)), cause
        case AlarmSwitched(at, kind, topic) if entry.active:
            yield ("alarm", kind, topic), Cause(at, "alarm", topic, "", f"{kind}: {entry.reason}")


def _kind_of_reason(reason: str) -> str:
    """Return a reason without its numbers, which differ from message to message."""
    return _NUMBER.sub("#", reason)
