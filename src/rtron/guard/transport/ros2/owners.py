"""Whose a node name is: the participant's that had it first, while it lives.

Names are not unique in ROS 2. Of two participants that come with one name at the same moment
neither has it: nobody can tell which is the right one.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class NameOwners:
    """Remembers, from what the graph lists at each look, who had a name first."""

    def __init__(self) -> None:
        self._owner_of: dict[str, bytes] = {}

    def update(self, names: Iterable[tuple[str, bytes]], *, is_settled: bool = True) -> None:
        """Take the node names that are there now, each with its participant.

        A name stays its owner's while that participant is there, under whatever name: what the
        domain says of names can be forged. Until the graph has `is_settled`, who was found first need
        not have been there first: then nobody has a name that two have.
        """
        participants_of: dict[str, set[bytes]] = defaultdict(set)
        for node, participant in names:
            participants_of[node].add(participant)
        present = set().union(*participants_of.values())
        self._owner_of = {node: owner for node, owner in self._owner_of.items() if owner in present}
        for node, participants in participants_of.items():
            if len(participants) > 1 and not is_settled:
                self._owner_of.pop(node, None)
            elif node and node not in self._owner_of and len(participants) == 1:
                self._owner_of[node] = next(iter(participants))

    def is_owner(self, node: str, participant: bytes) -> bool:
        """Tell whether a name is a participant's."""
        return self._owner_of.get(node) == participant
