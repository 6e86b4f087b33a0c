"""What the processes of the guard note for incidents, on its way to the recorder.

Times are ns of the machine's steady clock.
"""

from collections import deque
from typing import NamedTuple, TypeAlias

from rtron.vocabulary import Plan

LONGEST_MESSAGE = 1 << 16
"""The longest message of which the content is kept, bytes."""
_OVERHEAD = 256
"""About what an entry takes beside its message, bytes."""


class Received(NamedTuple):
    """A message of `size` bytes, and what became of it; `message` is empty if it is too long.

    `owner` is the flow that had the output then.
    """

    at: int
    topic: str
    flow: str
    message: bytes
    size: int
    owner: str
    decision: str
    policy: str
    reason: str
    revision: int


class Sent(NamedTuple):
    """A message that went out for a flow; `stopping` says why the robot is being stopped, if so."""

    at: int
    topic: str
    flow: str
    message: bytes
    size: int
    stopping: str


class ControlState(NamedTuple):
    """Who is in command of a stream, and what it may do: `limit` and `speed` are in m/s."""

    at: int
    topic: str
    owner: str
    publisher: str
    stopping: str
    limit: float | None
    speed: float | None


class LearnedType(NamedTuple):
    """The type of a stream's messages; `publishers` are the flows and their nodes."""

    topic: str
    type: str
    md5sum: str
    definition: str
    publishers: tuple[tuple[str, str], ...]


class EventMessage(NamedTuple):
    """A message that events are read from, as its publisher describes it."""

    at: int
    topic: str
    publisher: str
    type: str
    md5sum: str
    definition: str
    message: bytes


class RuleSwitched(NamedTuple):
    """A rule of the mission began or ceased to block."""

    at: int
    rule: str
    blocks: bool
    reason: str


class LeaseAnswered(NamedTuple):
    """Somebody asked a lease for something; `request` says who for what."""

    at: int
    lease: str
    request: str
    granted: bool
    reason: str


class Observed(NamedTuple):
    """What the speed limits and rules depend on.

    `rates` are fps_monitors: id, rate, when the last frame came (0: never). `events` are eflows:
    name, publishers, newest, judged, triggered, true_count, as `EventState` has them.
    """

    at: int
    rates: tuple[tuple[str, float, int], ...]
    events: tuple[tuple[str, int, int | None, bool | None, int | None, int], ...]


class AlarmSwitched(NamedTuple):
    """An alarm was raised, or cleared."""

    at: int
    alarm: str
    topic: str
    reason: str
    active: bool


class RevisionChanged(NamedTuple):
    """Other settings are in force; `settings` are JSON."""

    at: int
    revision: int
    settings: str


class EntriesLost(NamedTuple):
    """Entries found no room on their way."""

    at: int
    number: int


TimedEntry: TypeAlias = (
    Received
    | Sent
    | ControlState
    | EventMessage
    | RuleSwitched
    | LeaseAnswered
    | Observed
    | AlarmSwitched
    | RevisionChanged
    | EntriesLost
)
Entry: TypeAlias = TimedEntry | LearnedType


class NotedEntries(NamedTuple):
    """Entries of one process, in the order of their times."""

    entries: tuple[Entry, ...]


class EntryBuffer:
    """Entries that wait, within a bound; what finds no room is counted."""

    def __init__(self, max_bytes: int) -> None:
        self._max_bytes = max_bytes
        self._bytes = 0
        self._entries: deque[tuple[int, Entry]] = deque()
        self._lost = 0

    def add(self, entry: Entry, size: int = 0) -> None:
        """Keep an entry; `size` is how long what it has of a message is, bytes."""
        size += _OVERHEAD
        if self._bytes + size > self._max_bytes:
            self._lost += 1
            return
        self._bytes += size
        self._entries.append((size, entry))

    def take(self, max_bytes: int, now: int) -> list[Entry]:
        """Return the oldest entries, about `max_bytes` of them, and how many were lost, if any."""
        taken: list[Entry] = []
        while self._entries and max_bytes > 0:
            size, entry = self._entries.popleft()
            self._bytes -= size
            max_bytes -= size
            taken.append(entry)
        if self._lost:
            taken.append(EntriesLost(now, self._lost))
            self._lost = 0
        return taken


class RecorderTask(NamedTuple):
    """What the recorder is told first: the plan, the settings as JSON, and where it writes."""

    plan: Plan
    settings: str
    folder: str


class RecorderReport(NamedTuple):
    """What the recorder tells: why it cannot record, or nothing, and what it has saved last."""

    problem: str
    saved: str
