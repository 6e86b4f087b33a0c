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

    def look(self, listed: Iterable[tuple[str, bytes]], *, settled: bool = True) -> None:
        """Take the node names that are there now, each with its participant.

        A name stays its owner's while that participant is there, under whatever name: what the
        domain says of names can be forged. Until the graph has `settled`, who was found first need
        not have been there first: then nobody has a name that two have.
        """
        found: dict[str, set[bytes]] = defaultdict(set)
        for node, participant in listed:
            found[node].add(participant)
        there = set().union(*found.values())
        self._owner = {node: own for node, own in self._owner.items() if own in there}
        for node, participants in found.items():
            if len(participants) > 1 and not settled:
                self._owner.pop(node, None)
            elif node and node not in self._owner and len(participants) == 1:
                self._owner[node] = next(iter(participants))

    def has(self, node: str, participant: bytes) -> bool:
        """Tell whether a name is a participant's."""
        return self._owner.get(node) == participant
