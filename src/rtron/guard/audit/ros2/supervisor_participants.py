"""Which participants are the supervisors': they may say in the guard's place what stops the robot.

A supervisor is the process that has started the guard, one that the guard has started, or one that
has taken a running guard over; it has one participant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.guard.audit.ros2.observed_graph import Seen
    from rtron.guard.transport.ros2.participants import Lives
    from rtron.guard.transport.ros2.process_table import Process, Processes

_ITS_NODES = frozenset({GUARD_NODE, SUPERVISOR_NODE})
"""It sees the graph as the guard does."""


class Kin:
    """Remembers them as long as they are there: one that has died is in the graph for a while."""

    def __init__(self, lives: Lives, processes: Processes) -> None:
        self._lives = lives
        self._processes = processes
        self._known: dict[bytes, Process | None] = {}

    def found(self, seen: Seen) -> frozenset[bytes]:
        """Return those of the participants that are in the graph now."""
        there = {end.participant for end in seen.ends}
        known = {each: its for each, its in self._known.items() if each in there}
        self._known = {each: its for each, its in known.items() if self._may_stay(each, seen)}
        new = sorted(there - self._known.keys())
        self._known |= self._alone(each for each in new if self._is_kin(each, seen))
        named = seen.participants.get(SUPERVISOR_NODE, set())
        if not self._lives.tells and len(named) == 1:
            self._known |= dict.fromkeys(named)
        return frozenset(self._known)

    def _alone(self, found: Iterable[bytes]) -> dict[bytes, Process | None]:
        """Return those of processes that have no other participant here, with their processes."""
        processes = {each: self._lives.process(each) for each in found}
        taken = [*processes.values(), *self._known.values()]
        return {each: its for each, its in processes.items() if taken.count(its) == 1}

    def _is_kin(self, participant: bytes, seen: Seen) -> bool:
        process = self._lives.process(participant)
        return (
            process is not None
            and self._processes.is_kin(process[0])
            and self._may_stay(participant, seen)
        )

    def _may_stay(self, participant: bytes, seen: Seen) -> bool:
        """Tell whether it is a process of ours for certain, or has no name that is not ours."""
        return self._lives.is_certain(participant) or _names(participant, seen) <= _ITS_NODES


def _names(participant: bytes, seen: Seen) -> frozenset[str]:
    return frozenset(node for node, group in seen.participants.items() if participant in group)
