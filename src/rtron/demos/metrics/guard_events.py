"""What the guard decided in a run, from the events that the security service recorded."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from rtron.vocabulary import UNAPPROVED

Event = Mapping[str, Any]
"""An event as the service has it: `at` (wall ns), `kind`, `topic`, `flow`, `decision` and more."""
SECOND = 1_000_000_000
DECISIONS = ("pass", "hold", "drop", "modify")
_STOPPED = frozenset({"drop", "modify"})


@dataclass(frozen=True, slots=True)
class SecondCounts:
    """How many messages of a flow met which decision in the wall second that ends at `at` (ns)."""

    at: int
    topic: str
    flow: str
    counts: Mapping[str, int]


def decision_counts(events: Iterable[Event]) -> tuple[SecondCounts, ...]:
    """Return what the guard counted, second by second and flow by flow, in the order of time."""
    return tuple(
        SecondCounts(event["at"], topic, flow, dict(zip(DECISIONS, counts, strict=True)))
        for event in events
        if event["kind"] == "counts"
        for topic, stream in event["values"]["streams"].items()
        for flow, counts in stream["flows"].items()
    )


def first_stop(events: Iterable[Event], topic: str, attacker: str) -> float | None:
    """Return when (wall s) the first message of an attacker was stopped.

    None if no verdict tells so: one is told where it differs from its flow's before. A node that
    the plan does not name is an attacker, too.
    """
    verdict_times = (
        event["at"] / SECOND
        for event in events
        if event["kind"] == "verdict"
        and event["topic"] == topic
        and event["decision"] in _STOPPED
        and (event["publisher"] == attacker or event["flow"] == UNAPPROVED)
    )
    return min(verdict_times, default=None)
