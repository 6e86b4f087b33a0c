"""What the security service has recorded of a guard, asked of its API."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rtron.demos.runtime.polling import wait_for
from rtron.workflows.service_client import SecurityServiceClient
from rtron.workflows.service_events import stored_events

Event = Mapping[str, Any]
"""An event as the service has it: `at` (wall ns), `kind`, `topic`, `flow`, `decision`, `reason`…"""
_SECOND = 1_000_000_000
_STORE_DELAY = 1.5
"""Seconds after which what the guard had to tell of a moment is stored: it tells once a second."""


@dataclass(frozen=True, slots=True)
class DecisionCounts:
    """How many messages of a flow met which decision."""

    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0

    def __add__(self, other: "DecisionCounts") -> "DecisionCounts":
        return DecisionCounts(
            self.passed + other.passed,
            self.held + other.held,
            self.dropped + other.dropped,
            self.modified + other.modified,
        )


@dataclass(frozen=True, slots=True)
class EventHistory:
    """The events of one robot's guard. The errors are those of the client.

    Times are ns of the wall clock; `until` is excluded, None is now.
    """

    client: SecurityServiceClient
    robot: str

    def robots(self) -> list[Mapping[str, Any]]:
        """Return the robots that the service knows, with the state of each one's guard."""
        found: list[Mapping[str, Any]] = self.client.get("robots")
        return found

    def state(self) -> Mapping[str, Any] | None:
        """Return what the guard told of itself last (a GuardState as JSON); None: nothing yet."""
        found: list[Mapping[str, Any] | None]
        found = [each["state"] for each in self.robots() if each["name"] == self.robot]
        return found[0] if found else None

    def wait_until_linked(self, since: int) -> None:
        """Wait until a guard that runs has told its state at `since` or later."""
        wait_for(
            lambda: self._last_state_time() >= since, "the guard to tell the service of itself"
        )

    def events(self, since: int, until: int | None = None, kind: str = "") -> list[Event]:
        """Return events in the order of time, once all of them are stored."""
        end = time.time_ns() if until is None else until
        self.wait_until_linked(end + int(_STORE_DELAY * _SECOND))
        found = stored_events(
            self.client, robot=self.robot, since=since, until=end, kind=kind or None
        )
        return sorted(found, key=lambda event: event["at"])

    def counts(self, since: int, until: int | None = None) -> dict[str, dict[str, DecisionCounts]]:
        """Return by topic and flow how many messages met which decision."""
        return sum_decision_counts(self.events(since, until, "counts"))

    def _last_state_time(self) -> int:
        state = self.state()
        return int(state["at"]) if state else 0


def sum_decision_counts(events: list[Event]) -> dict[str, dict[str, DecisionCounts]]:
    """Return the sums of `counts` events, by topic and flow."""
    found: dict[str, dict[str, DecisionCounts]] = {}
    for event in events:
        for topic, stream in event["values"]["streams"].items():
            flows = found.setdefault(topic, {})
            for flow, tally in stream["flows"].items():
                flows[flow] = flows.get(flow, DecisionCounts()) + DecisionCounts(*tally)
    return found
