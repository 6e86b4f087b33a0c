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
class Tallied:
    """How many messages of a flow met which decision in the wall second that ends at `at` (ns)."""

    at: int
    topic: str
    flow: str
    counts: Mapping[str, int]


def tallies(events: Iterable[Event]) -> tuple[Tallied, ...]:
    """Return what the guard counted, second by second and flow by flow, in the order of time."""
    return tuple(
        Tallied(event["at"], topic, flow, dict(zip(DECISIONS, counts, strict=True)))
        for event in events
        if event["kind"] == "counts"
        for topic, stream in event["values"]["streams"].items()
        for flow, counts in stream["flows"].items()
    )


def stopped_at(
    events: Iterable[Event], topic: str, attacker: str, since: float = 0.0
) -> float | None:
    """Return when (wall s) the first message of an attacker was stopped, from `since` (wall s) on.

    None if no verdict tells so: one is told where it differs from its flow's before. A node that
    the plan does not name is an attacker, too.
    """
    told = (
        event["at"] / SECOND
        for event in events
        if event["kind"] == "verdict"
        and event["topic"] == topic
        and event["decision"] in _STOPPED
        and (event["publisher"] == attacker or event["flow"] == UNAPPROVED)
    )
    return min((at for at in told if at >= since), default=None)
