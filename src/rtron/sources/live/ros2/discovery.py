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
    from rtron.sources.live.ros2.domain import Domain, Snapshot

LEAST_S = 3.5
"""How long after joining a graph counts as whole at the earliest."""
_PAUSE_S = 0.05
_LATE_S = 0.15
"""Who looks so much later than meant says nothing: others are as late."""
_STILL = 10
"""Signs that must agree before the whole graph is looked at: 0.5 s at least."""
_PROMPT_S = 4.5
"""Who is heard of later than this had to say it twice, and others may have to say it thrice."""
_PERIOD = 64
"""Signs that must agree then: 3.2 s at least, a whole period of announcements."""
_AGAIN = 5
"""Signs that must agree before it is looked at again."""
_LOOK_S = 10.0
"""The longest that one look at the whole graph may take."""


@dataclass(frozen=True, slots=True)
class Settled:
    """The graph as it was in the end, and whether it stood still then."""

    seen: Snapshot
    still: bool


def settled(domain: Domain, timeout: float) -> Settled:
    """Return the graph of a domain when it has settled, or what there is after `timeout` (s)."""
    start = time.monotonic()
    end = start + timeout
    changed = _steady(domain, _STILL, min(start + LEAST_S, end), end)
    if changed > start + _PROMPT_S:
        _steady(domain, _PERIOD, 0.0, end)
    seen = domain.look(_LOOK_S)
    while True:
        _steady(domain, _AGAIN, 0.0, end)
        before, seen = seen, domain.look(_LOOK_S)
        still = seen == before
        if (still and seen.whole) or time.monotonic() >= end:
            return Settled(seen, still)


def _steady(domain: Domain, looks: int, least: float, end: float) -> float:
    """Return when the sign changed last, once it was the same so many times; 0 if it did not.

    Not before the time is `least`, and at once when it is `end`.
    """
    sign, same, changed = domain.sign(), 0, 0.0
    while (same < looks or time.monotonic() < least) and time.monotonic() < end:
        asked = time.monotonic()
        time.sleep(_PAUSE_S)
        now, late = domain.sign(), time.monotonic() - asked > _LATE_S
        if now != sign:
            changed = time.monotonic()
        sign, same = now, same + (not late) if now == sign else 0
    return changed
