"""Which participants still live, although the domain has not said that they do not.

A node that ends in order says so. One that is killed stays in the graph until its lease is over,
20 s with Fast DDS, while the one that was started in its place is there already. On one machine
the process tells it. Fast DDS makes a GID of the host's id, of the lower half of the id that the
process knows itself by, and of 2 random bytes, the same for all participants of a process
(GuidUtils.hpp: bytes 2 and 3, 4 and 5, 6 and 7). The host's id is made of its addresses: whoever
shares our network has it, in a container too.

So a participant is gone only if it certainly was a process that has ended: every process of the
machine is seen here, one alone knows itself by such an id, that one has Fast DDS loaded and is in
our network, and nobody with other random bytes is taken for it. Whoever is not certain is waited
for. What remains: a guard in a container with process ids of its own does not see everybody, and
waits for the lease always; a process that was forked from one which used Fast DDS already, and did
not start another program, has its parent's GIDs and is taken for gone with it; and a GID is only
what somebody claims.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND, StringEnum

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from rtron.guard.transport.ros2.process_table import Process, ProcessMatch, ProcessTable


MAX_LEASE = 25 * SECOND
"""How long a participant that is dead may be in the graph, with some to spare."""
_FAST_DDS = b"\x01\x0f"
_HOST = 4
_PID = 6
_PROCESS = 8
_MAX_SEARCHED = 32
"""So many processes are looked for at a time: each costs some reading."""


class ParticipantState(StringEnum):
    """What is known of a participant: its process runs, has ended, or cannot be seen from here."""

    RUNNING = "runs"
    ENDED = "gone"
    UNKNOWN = "untold"


class ParticipantLiveness:
    """Remembers when each participant came (ns), and which process of this machine it is."""

    def __init__(self, own_participant: bytes, processes: ProcessTable) -> None:
        """`own_participant` is a participant of this process."""
        self.has_process_ids = own_participant.startswith(_FAST_DDS)
        """Whether GIDs tell processes at all."""
        self._own_host_id = own_participant[:_HOST]
        self._processes = processes
        self._first_seen: dict[bytes, int] = {}
        self._matches: dict[bytes, ProcessMatch | None] = {}

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
        """Return when a participant came, 0 if it is not there."""
        return self._first_seen.get(participant, 0)

    def state(self, participant: bytes) -> ParticipantState:
        """Return what is known of a participant at this moment."""
        match = self._matches.get(participant)
        if match and self._processes.is_running(match.process):
            return ParticipantState.RUNNING
        certain = match is not None and match.is_certain and self._processes.is_proc_mounted()
        return ParticipantState.ENDED if certain else ParticipantState.UNKNOWN

    def not_ended(self, participants: Iterable[bytes]) -> frozenset[bytes]:
        """Return those that are not known to be gone: of a name that only one has, that one."""
        candidates = frozenset(participants)
        if len(candidates) < 2:  # noqa: PLR2004 - nothing to be told apart
            return candidates
        return frozenset(
            each for each in candidates if self.state(each) is not ParticipantState.ENDED
        )

    def has_conflict(self, participants: Iterable[bytes], now: int) -> bool:
        """Tell whether two of a name's participants certainly live.

        The last to come does: it has just been discovered. Another one may be dead and unseen from
        here until a lease has passed since then.
        """
        candidates = sorted(self.not_ended(participants), key=lambda each: (self.since(each), each))
        if len(candidates) < 2:  # noqa: PLR2004
            return False
        late = now - self.since(candidates[-1]) >= MAX_LEASE
        return late or any(self.state(each) is ParticipantState.RUNNING for each in candidates[:-1])

    def process(self, participant: bytes) -> Process | None:
        """Return the process of this machine that a participant seems to be in."""
        match = self._matches.get(participant)
        return match.process if match else None

    def is_certain(self, participant: bytes) -> bool:
        """Tell whether a participant can be in no other process than that one."""
        match = self._matches.get(participant)
        return match is not None and match.is_certain

    def _match_process(self, participant: bytes) -> None:
        """Find a participant's process; two of one process agree about what is random in it."""
        match = self._processes.find(int.from_bytes(participant[_HOST:_PID], "little"))
        self._matches[participant] = match
        if match:
            rivals = [each for each in self._matches if self._are_rivals(each, participant)]
            for each in (participant, *rivals) if rivals else ():
                self._matches[each] = replace(match, is_certain=False)

    def _are_rivals(self, participant: bytes, other: bytes) -> bool:
        process = self.process(participant)
        same = process is not None and process == self.process(other)
        return same and participant[:_PROCESS] != other[:_PROCESS]


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
