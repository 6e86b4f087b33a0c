"""Liveness of participants, owners of node names, and the endpoints that the guard knows.

A node that ends in order leaves the graph. One that is killed stays there until its lease is over,
20 s with Fast DDS, while its replacement is there already. On one machine the process shows which
one has ended. Fast DDS makes a GID of the host's id, of the lower half of the id that the
process knows itself by, and of 2 random bytes, the same for all participants of a process
(GuidUtils.hpp: bytes 2 and 3, 4 and 5, 6 and 7). The host's id is made of its addresses: whoever
shares our network has it, in a container too.

So a participant has ended only if it certainly was a process that has ended: the guard sees every
process of the machine, exactly one has such an id, that one has Fast DDS loaded and is in our
network, and no participant with other random bytes matches it. In doubt the guard waits for the
lease. Limits: a guard in a container with process ids of its own does not see all processes, and
always waits for the lease; a process that was forked from one which used Fast DDS already, and did
not start another program, has its parent's GIDs and counts as ended with it; and a GID is only a
claim.

A guard that starts can match no process that has ended before: it gets the matches of the guard
before it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from rtron.guard.transport.ros2.process_table import ProcessMatch
from rtron.vocabulary import SECOND, StringEnum

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from rtron.guard.transport.ros2.process_table import Process, ProcessTable


MAX_LEASE = 25 * SECOND
"""How long an ended participant may stay in the graph, with a margin."""
_FAST_DDS = b"\x01\x0f"
_HOST = 4
_PID = 6
_PROCESS = 8
_MAX_SEARCHED = 32
"""The most processes that one update looks for: each costs some reading."""


class ParticipantState(StringEnum):
    """The state of a participant: its process runs, has ended, or cannot be seen from here."""

    RUNNING = "running"
    ENDED = "ended"
    UNKNOWN = "unknown"


class ParticipantLiveness:
    """Remembers when each participant came (ns), and its process on this machine."""

    def __init__(self, own_participant: bytes, processes: ProcessTable) -> None:
        """`own_participant` is a participant of this process."""
        self.has_process_ids = own_participant.startswith(_FAST_DDS)
        """Whether GIDs contain process ids at all."""
        self._own_host_id = own_participant[:_HOST]
        self._processes = processes
        self._first_seen: dict[bytes, int] = {}
        self._matches: dict[bytes, ProcessMatch | None] = {}
        self._inherited: Mapping[bytes, Process] = {}

    def inherit(self, processes: Mapping[bytes, Process]) -> None:
        """Take what the guard before knew for certain, in place of what was inherited before."""
        self._inherited = processes

    def certain_processes(self) -> dict[bytes, Process]:
        """Return the participants that belong to one process for certain, for the next guard."""
        undiscovered = self._inherited.keys() - self._matches.keys()
        certain = {each: self._inherited[each] for each in sorted(undiscovered)}
        for each, match in self._matches.items():
            if match and match.is_certain:
                certain[each] = match.process
        return certain

    def update(self, participants: Iterable[bytes], now: int) -> None:
        """Take all the participants that are in the graph now."""
        participants_now = sorted(set(participants))
        self._first_seen = {each: self._first_seen.get(each, now) for each in participants_now}
        self._matches = {
            each: self._matches[each] for each in participants_now if each in self._matches
        }
        if self.has_process_ids:
            self._processes.update(now)
            near = (each for each in participants_now if each.startswith(self._own_host_id))
            for each in islice((each for each in near if each not in self._matches), _MAX_SEARCHED):
                self._match_process(each)

    def since(self, participant: bytes) -> int:
        """Return when a participant came (ns), 0 if it is not there."""
        return self._first_seen.get(participant, 0)

    def state(self, participant: bytes) -> ParticipantState:
        """Return the current state of a participant."""
        match = self._matches.get(participant)
        if match and self._processes.is_running(match.process):
            return ParticipantState.RUNNING
        certain = match is not None and match.is_certain and self._processes.is_proc_mounted()
        return ParticipantState.ENDED if certain else ParticipantState.UNKNOWN

    def not_ended(self, participants: Iterable[bytes]) -> frozenset[bytes]:
        """Return the participants of a name that have not ended; a single one stays."""
        candidates = frozenset(participants)
        if len(candidates) < 2:  # noqa: PLR2004 - no others
            return candidates
        return frozenset(
            each for each in candidates if self.state(each) is not ParticipantState.ENDED
        )

    def has_conflict(self, participants: Iterable[bytes], now: int) -> bool:
        """Return whether two of a name's participants certainly run.

        The last to come does: it was just discovered. An earlier one may have ended unseen, until a
        lease has passed since then.
        """
        candidates = sorted(self.not_ended(participants), key=lambda each: (self.since(each), each))
        if len(candidates) < 2:  # noqa: PLR2004
            return False
        late = now - self.since(candidates[-1]) >= MAX_LEASE
        return late or any(self.state(each) is ParticipantState.RUNNING for each in candidates[:-1])

    def process(self, participant: bytes) -> Process | None:
        """Return the process of this machine that a participant seems to belong to."""
        match = self._matches.get(participant)
        return match.process if match else None

    def is_certain(self, participant: bytes) -> bool:
        """Return whether a participant can belong to no other process."""
        match = self._matches.get(participant)
        return match is not None and match.is_certain

    def _match_process(self, participant: bytes) -> None:
        """Find a participant's process; those of one process have the same random bytes."""
        match = self._find_process(participant)
        self._matches[participant] = match
        if match:
            rivals = [each for each in self._matches if self._are_rivals(each, participant)]
            for each in (participant, *rivals) if rivals else ():
                self._matches[each] = replace(match, is_certain=False)

    def _find_process(self, participant: bytes) -> ProcessMatch | None:
        inherited = self._inherited.get(participant)
        if inherited:
            return ProcessMatch(inherited, is_certain=True)
        return self._processes.find(int.from_bytes(participant[_HOST:_PID], "little"))

    def _are_rivals(self, participant: bytes, other: bytes) -> bool:
        process = self.process(participant)
        same = process is not None and process == self.process(other)
        return same and participant[:_PROCESS] != other[:_PROCESS]


class NameOwners:
    """Remembers which participant had each node name first."""

    def __init__(self) -> None:
        self._owner_of: dict[str, bytes] = {}

    def update(self, names: Iterable[tuple[str, bytes]], *, is_settled: bool = True) -> None:
        """Take the node names in the graph, each with its participant.

        A participant owns a name as long as it is there, under whatever name: names in the graph
        can be forged. Until the graph `is_settled`, the first participant found need not be the
        first to come, so nobody owns a name that two participants have.
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
        """Return whether a participant owns a name."""
        return self._owner_of.get(node) == participant


MAX_ENDPOINTS = 256
"""The most publishers, and the most subscribers, that are known of a topic."""
MAX_PER_PARTICIPANT = 16
"""The number of endpoints of one participant that have precedence."""
_PARTICIPANT = 12


def select_endpoints(gids: Collection[bytes], known_gids: Collection[bytes]) -> list[bytes]:
    """Return the GIDs of the endpoints to know now, at most 256, sorted.

    Known endpoints stay, up to 16 of each participant: later ones do not displace them, and no
    single participant keeps all others out.
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
    """Yield for each endpoint whether it exceeds its participant's share."""
    shares: Counter[bytes] = Counter()
    for gid in gids:
        shares[gid[:_PARTICIPANT]] += 1
        yield shares[gid[:_PARTICIPANT]] > MAX_PER_PARTICIPANT
