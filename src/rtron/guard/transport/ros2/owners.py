"""Whose a node name is: the participant's that had it first, while it lives.

Names are not unique in ROS 2. Of two participants that come with one name at the same moment
neither has it: nobody can tell which is the right one.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class Owners:
    """Remembers, from what the graph lists at each look, who had a name first."""

    def __init__(self) -> None:
        self._owner: dict[str, bytes] = {}

    def look(self, listed: Iterable[tuple[str, bytes]]) -> None:
        """Take the node names that are there now, each with its participant."""
        found: dict[str, set[bytes]] = defaultdict(set)
        for node, participant in listed:
            found[node].add(participant)
        self._owner = {node: own for node, own in self._owner.items() if own in found.get(node, ())}
        for node, participants in found.items():
            if node and node not in self._owner and len(participants) == 1:
                self._owner[node] = next(iter(participants))

    def has(self, node: str, participant: bytes) -> bool:
        """Tell whether a name is a participant's."""
        return self._owner.get(node) == participant
