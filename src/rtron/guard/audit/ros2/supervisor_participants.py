"""Which participants are the supervisor's: it may say in the guard's place what stops the robot.

It has one. Where GIDs contain process ids these tell which it is, and which the guards before it
had; elsewhere the supervisor itself does, in the memory that it shares with the guard.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.guard.audit.ros2.observed_graph import ObservedGraph
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.guard.transport.ros2.participants import ParticipantLiveness
    from rtron.guard.transport.ros2.process_table import Process

_SUPERVISOR_NODES = frozenset({GUARD_NODE, SUPERVISOR_NODE})
"""It sees the graph as the guard does."""


class SupervisorParticipants:
    """Remembers them as long as they are there: one that has died is in the graph for a while."""

    def __init__(self, liveness: ParticipantLiveness, transport: Ros2Transport) -> None:
        self._liveness = liveness
        self._processes = transport.processes
        self._transport = transport
        self._known: dict[bytes, Process | None] = {}

    def update(self, observed: ObservedGraph) -> frozenset[bytes]:
        """Return those of the participants that are in the graph now."""
        present = {end.participant for end in observed.endpoints}
        known = {each: process for each, process in self._known.items() if each in present}
        self._known = {
            each: process for each, process in known.items() if self._is_trusted(each, observed)
        }
        new = sorted(present - self._known.keys())
        self._known |= self._with_own_process(
            each for each in new if self._is_supervisor(each, observed)
        )
        has_process_ids = self._liveness.has_process_ids
        return frozenset(self._known) if has_process_ids else self._announced(present, observed)

    def _announced(self, present: set[bytes], observed: ObservedGraph) -> frozenset[bytes]:
        """Return the one that our supervisor has; until it has told, all that have its name."""
        announced = self._transport.supervisor_participant()
        if not announced:
            return frozenset(observed.participants.get(SUPERVISOR_NODE, ()))
        return frozenset({announced} & present)

    def _with_own_process(self, participants: Iterable[bytes]) -> dict[bytes, Process | None]:
        """Return those of processes that have no other participant here, with their processes."""
        processes = {each: self._liveness.process(each) for each in participants}
        taken = [*processes.values(), *self._known.values()]
        return {each: process for each, process in processes.items() if taken.count(process) == 1}

    def _is_supervisor(self, participant: bytes, observed: ObservedGraph) -> bool:
        process = self._liveness.process(participant)
        return (
            process is not None
            and self._processes.is_related(process[0])
            and self._is_trusted(participant, observed)
        )

    def _is_trusted(self, participant: bytes, observed: ObservedGraph) -> bool:
        """Tell whether it is a process of ours for certain, or has no name that is not ours."""
        return (
            self._liveness.is_certain(participant)
            or _names(participant, observed) <= _SUPERVISOR_NODES
        )


def _names(participant: bytes, observed: ObservedGraph) -> frozenset[str]:
    return frozenset(node for node, group in observed.participants.items() if participant in group)
