"""When the graph of a domain is whole: it stands still, and all has been told of whoever is there.

Nobody tells the end of discovery. What was missed comes again with the next announcement or
heartbeat, which Fast DDS sends every 3 s: so long a graph may stand still and not be whole (of 30
joins of an app of 20 processes on a busy machine, 13 were whole only after 2.5 to 4.4 s). So it is
not looked at before, and of each participant all must be there that it says to have. What counts
beside that is looks in time and not seconds: a machine too busy to hear of changes takes longer.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtron.sources.live.ros2.domain import DomainReader, Snapshot

MIN_DISCOVERY_S = 3.5
"""How long after joining a graph counts as whole at the earliest."""
_POLL_S = 0.05
_LATE_POLL_S = 0.15
"""Who looks so much later than meant says nothing: others are as late."""
_STABLE_POLLS = 10
"""Signs that must agree before the whole graph is looked at: 0.5 s at least."""
_PROMPT_DISCOVERY_S = 4.5
"""Who is heard of later than this had to say it twice, and others may have to say it thrice."""
_ANNOUNCEMENT_POLLS = 64
"""Signs that must agree then: 3.2 s at least, a whole period of announcements."""
_STABLE_POLLS_BETWEEN_SNAPSHOTS = 5
"""Signs that must agree before it is looked at again."""
_SNAPSHOT_TIMEOUT_S = 10.0
"""The longest that one look at the whole graph may take."""


@dataclass(frozen=True, slots=True)
class DiscoveredGraph:
    """The graph as it was in the end, and whether it stood still then."""

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
    """Return when the sign changed last, once it was the same so many times; 0 if it did not.

    Not before the time is `earliest`, and at once when it is `deadline`.
    """
    fingerprint, equal_polls, last_change = domain.fingerprint(), 0, 0.0
    while (equal_polls < polls or time.monotonic() < earliest) and time.monotonic() < deadline:
        polled_at = time.monotonic()
        time.sleep(_POLL_S)
        current, late = domain.fingerprint(), time.monotonic() - polled_at > _LATE_POLL_S
        if current != fingerprint:
            last_change = time.monotonic()
        fingerprint, equal_polls = (
            current,
            equal_polls + (not late) if current == fingerprint else 0,
        )
    return last_change
