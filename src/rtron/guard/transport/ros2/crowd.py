"""Whom of a crowd on one topic the guard knows: strangers may make endpoints without end."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

MAX_ENDPOINTS = 256
"""So many publishers, and so many subscribers, are known of a topic."""
MAX_PER_PARTICIPANT = 16
"""So many of them, of one participant, have their place before others."""
_PARTICIPANT = 12


def select_endpoints(gids: Collection[bytes], known_gids: Collection[bytes]) -> list[bytes]:
    """Return the GIDs of the endpoints to know now, at most 256, in their order.

    Whoever is known already stays, up to 16 of a participant: nobody is pushed out by who comes
    later, and no single one keeps all others out.
    """
    candidates = sorted(gids)
    if len(candidates) <= MAX_ENDPOINTS:
        return candidates
    candidates.sort(key=lambda gid: gid not in known_gids)
    ranked = sorted(
        zip(_exceeds_share(candidates), candidates, strict=True), key=lambda pair: pair[0]
    )
    return sorted(gid for _, gid in ranked[:MAX_ENDPOINTS])


def _exceeds_share(gids: Iterable[bytes]) -> Iterator[bool]:
    """Yield of each endpoint whether its participant has had its share before it."""
    shares: Counter[bytes] = Counter()
    for gid in gids:
        shares[gid[:_PARTICIPANT]] += 1
        yield shares[gid[:_PARTICIPANT]] > MAX_PER_PARTICIPANT
