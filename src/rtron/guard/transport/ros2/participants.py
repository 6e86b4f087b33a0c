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

from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from rtron.vocabulary import SECOND, Word

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.guard.transport.ros2.process_table import Match, Process, Processes

LEASE = 25 * SECOND
"""How long a participant that is dead may be in the graph, with some to spare."""
_FAST_DDS = b"\x01\x0f"
_HOST = 4
_PID = 6
_PROCESS = 8
_MOST_SOUGHT = 32
"""So many processes are looked for at a time: each costs some reading."""


class Life(Word):
    """What is known of a participant: its process runs, has ended, or cannot be seen from here."""

    RUNS = "runs"
    GONE = "gone"
    UNTOLD = "untold"


class Lives:
    """Remembers when each participant came (ns), and which process of this machine it is."""

    def __init__(self, own: bytes, processes: Processes) -> None:
        """`own` is a participant of this process."""
        self.tells = own.startswith(_FAST_DDS)
        """Whether GIDs tell processes at all."""
        self._here = own[:_HOST]
        self._processes = processes
        self._since: dict[bytes, int] = {}
        self._found: dict[bytes, Match | None] = {}

    def look(self, participants: Iterable[bytes], now: int) -> None:
        """Take all the participants that are in the graph now."""
        there = sorted(set(participants))
        self._since = {each: self._since.get(each, now) for each in there}
        self._found = {each: self._found[each] for each in there if each in self._found}
        if self.tells:
            self._processes.look(now)
            near = (each for each in there if each.startswith(self._here))
            for each in islice((each for each in near if each not in self._found), _MOST_SOUGHT):
                self._seek(each)

    def since(self, participant: bytes) -> int:
        """Return when a participant came, 0 if it is not there."""
        return self._since.get(participant, 0)

    def of(self, participant: bytes) -> Life:
        """Return what is known of a participant at this moment."""
        match = self._found.get(participant)
        if match and self._processes.lives(match.process):
            return Life.RUNS
        certain = match is not None and match.certain and self._processes.are_seen()
        return Life.GONE if certain else Life.UNTOLD

    def living(self, participants: Iterable[bytes]) -> frozenset[bytes]:
        """Return those that are not known to be gone: of a name that only one has, that one."""
        found = frozenset(participants)
        if len(found) < 2:  # noqa: PLR2004 - nothing to be told apart
            return found
        return frozenset(each for each in found if self.of(each) is not Life.GONE)

    def clash(self, participants: Iterable[bytes], now: int) -> bool:
        """Tell whether two of a name's participants certainly live.

        The last to come does: it has just been discovered. Another one may be dead and unseen from
        here until a lease has passed since then.
        """
        found = sorted(self.living(participants), key=lambda each: (self.since(each), each))
        if len(found) < 2:  # noqa: PLR2004
            return False
        late = now - self.since(found[-1]) >= LEASE
        return late or any(self.of(each) is Life.RUNS for each in found[:-1])

    def process(self, participant: bytes) -> Process | None:
        """Return the process of this machine that a participant seems to be in."""
        match = self._found.get(participant)
        return match.process if match else None

    def is_certain(self, participant: bytes) -> bool:
        """Tell whether a participant can be in no other process than that one."""
        match = self._found.get(participant)
        return match is not None and match.certain

    def _seek(self, participant: bytes) -> None:
        """Find a participant's process; two of one process agree about what is random in it."""
        match = self._processes.find(int.from_bytes(participant[_HOST:_PID], "little"))
        self._found[participant] = match
        if match:
            rivals = [each for each in self._found if self._contradict(each, participant)]
            for each in (participant, *rivals) if rivals else ():
                self._found[each] = replace(match, certain=False)

    def _contradict(self, one: bytes, other: bytes) -> bool:
        process = self.process(one)
        same = process is not None and process == self.process(other)
        return same and one[:_PROCESS] != other[:_PROCESS]
