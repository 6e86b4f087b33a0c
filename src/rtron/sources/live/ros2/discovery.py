"""When the graph of a domain is complete: it is stable, and every participant is fully known.

DDS does not announce the end of discovery. What was missed comes again with the next announcement
or heartbeat, which Fast DDS sends every 3 s: a graph may be stable for that long and incomplete (of
30 joins of an app of 20 processes on a busy machine, 13 were complete only after 2.5 to 4.4 s). So
no snapshot is taken before, and each participant must have all endpoints that it announces. Beside
that, polls in time count and not seconds: a machine too busy to receive changes takes longer.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtron.sources.live.ros2.domain import DomainReader, Snapshot

MIN_DISCOVERY_S = 3.5
"""How long after joining a graph counts as complete at the earliest."""
_POLL_S = 0.05
_LATE_POLL_S = 0.15
"""A poll so much later than meant does not count: other processes are as late."""
_STABLE_POLLS = 10
"""Equal fingerprints before the first snapshot: 0.5 s at least."""
_PROMPT_DISCOVERY_S = 4.5
"""What is discovered later than this took two announcements; another may take three."""
_ANNOUNCEMENT_POLLS = 64
"""Equal fingerprints that are then needed: 3.2 s at least, a whole period of announcements."""
_STABLE_POLLS_BETWEEN_SNAPSHOTS = 5
"""Equal fingerprints before each further snapshot."""
_SNAPSHOT_TIMEOUT_S = 10.0
"""The longest that one snapshot may take."""


@dataclass(frozen=True, slots=True)
class DiscoveredGraph:
    """The graph as it was in the end, and whether it was stable then."""

    snapshot: Snapshot
    is_stable: bool


def discover_graph(domain: DomainReader, timeout: float) -> DiscoveredGraph:
    """Return the graph of a domain when it has settled, or what there is after `timeout` (s)."""
    start = time.monotonic()
    deadline = start + timeout
    last_change = _wait_until_stable(
        domain, _STABLE_POLLS, min(start + MIN_DISCOVERY_S, deadline), deadline
    )
    if last_change > start + _PROMPT_DISCOVERY_S:
        _wait_until_stable(domain, _ANNOUNCEMENT_POLLS, 0.0, deadline)
    snapshot = domain.snapshot(_SNAPSHOT_TIMEOUT_S)
    while True:
        _wait_until_stable(domain, _STABLE_POLLS_BETWEEN_SNAPSHOTS, 0.0, deadline)
        previous, snapshot = snapshot, domain.snapshot(_SNAPSHOT_TIMEOUT_S)
        is_stable = snapshot == previous
        if (is_stable and snapshot.is_complete) or time.monotonic() >= deadline:
            return DiscoveredGraph(snapshot, is_stable)


def _wait_until_stable(domain: DomainReader, polls: int, earliest: float, deadline: float) -> float:
    """Return when the fingerprint changed last, once it was equal `polls` times; 0 for never.

    Return not before the time is `earliest`, and at once when it is `deadline`.
    """
    fingerprint, equal_polls, last_change = domain.fingerprint(), 0, 0.0
    while (equal_polls < polls or time.monotonic() < earliest) and time.monotonic() < deadline:
        polled_at = time.monotonic()
        time.sleep(_POLL_S)
        current = domain.fingerprint()
        if current != fingerprint:
            fingerprint, equal_polls, last_change = current, 0, time.monotonic()
        elif time.monotonic() - polled_at <= _LATE_POLL_S:
            equal_polls += 1
    return last_change
