"""Whom of a crowd on one topic the guard knows: strangers may make endpoints without end."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

MOST = 256
"""So many publishers, and so many subscribers, are known of a topic."""
MOST_OF_ONE = 16
"""So many of them, of one participant, have their place before others."""
_PARTICIPANT = 12


def to_know(gids: Collection[bytes], known: Collection[bytes]) -> list[bytes]:
    """Return the GIDs of the endpoints to know now, at most 256, in their order.

    Whoever is known already stays, up to 16 of a participant: nobody is pushed out by who comes
    later, and no single one keeps all others out.
    """
    found = sorted(gids)
    if len(found) <= MOST:
        return found
    found.sort(key=lambda gid: gid not in known)
    ranked = sorted(zip(_are_many(found), found, strict=True), key=lambda pair: pair[0])
    return sorted(gid for _, gid in ranked[:MOST])


def _are_many(gids: Iterable[bytes]) -> Iterator[bool]:
    """Yield of each endpoint whether its participant has had its share before it."""
    shares: Counter[bytes] = Counter()
    for gid in gids:
        shares[gid[:_PARTICIPANT]] += 1
        yield shares[gid[:_PARTICIPANT]] > MOST_OF_ONE
