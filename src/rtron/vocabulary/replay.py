"""What a replay found: what would have become of every recorded message."""

from dataclasses import dataclass

REPLAY_SCHEMA = "rtron.replay/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayFlowCounts:
    """What would have become of a flow's messages.

    A held message counts again when it passes or is dropped.
    """

    flow: str
    publisher: str
    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayStreamCounts:
    """What would have become of a topic's messages; `stops` counts the stop waves."""

    topic: str
    nodes: tuple[str, ...]
    flows: tuple[ReplayFlowCounts, ...]
    stops: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionChange:
    """A change in what happens on a topic, `at` ns after the first recorded message."""

    at: int
    topic: str
    flow: str
    decision: str
    policy: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayReport:
    """A whole replay: counts, changes in the order of time, and what was not judged and why.

    `duration` is the recording's, ns; `messages` counts all that were read; `unseen` the changes
    beyond the most that are kept.
    """

    messages: int
    duration: int
    streams: tuple[ReplayStreamCounts, ...]
    changes: tuple[DecisionChange, ...]
    notes: tuple[str, ...] = ()
    unseen: int = 0
