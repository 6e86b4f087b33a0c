"""Whose a request is: a node of the participant that sent it, as the graph tells.

A client of an action also subscribes its topics (rcl_action), so the graph names its node there.
Once that is an approved name of its own there, it stays: no endpoint changes its node, and anybody
can tell the domain another name for it.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import SECOND, TOLD, end_name, names_node
from rtron.wire.ros2.endpoints import PARTICIPANT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtron.guard.transport.ros2.context import Surroundings
    from rtron.wire.ros2.endpoints import Ros2Endpoint

    Take = Callable[[Peer], None]

_AWAIT_NAME = SECOND
_MOST_UNNAMED = 256
_MOST_OF_ONE = 32


class Callers:
    """Names the senders of requests under one name of an action; the nameless wait a moment."""

    def __init__(self, action: str, publisher: str, info: TypeInfo, shared: Surroundings) -> None:
        self._topics = [end_name(action, end) for end in TOLD]
        self._publisher = publisher
        self._info = info
        self._graph = shared.graph
        self._loop = shared.loop
        self._owners = shared.owners
        self._unnamed: deque[tuple[int, bytes, Take]] = deque()
        self._approved: dict[bytes, str] = {}
        for topic in self._topics:
            self._graph.watch(topic)
        self._graph.changed.append(self.update)

    def close(self) -> None:
        """Name nobody any more."""
        self._graph.changed.remove(self.update)

    def name(self, place: bytes, take: Take) -> None:
        """Call `take` with the sender of a request, now or when the graph knows it."""
        participant = place[:PARTICIPANT]
        peer = self._peer(participant)
        if peer or self._is_full(participant):
            take(peer or self._stranger(participant))
        else:
            self._unnamed.append((self._loop.now(), participant, take))
            for topic in self._topics:
                self._graph.look(topic)

    def _is_full(self, participant: bytes) -> bool:
        """Tell whether no more may wait, of all or of one: it shall not crowd out the others."""
        own = sum(each == participant for _, each, _ in self._unnamed)
        return own >= _MOST_OF_ONE or len(self._unnamed) >= _MOST_UNNAMED

    def update(self) -> None:
        """Take what the graph says: name who has waited for it, or waited for too long."""
        self._approved = {end.gid: node for end, node in self._named() if self._may_keep(end, node)}
        now, waiting = self._loop.now(), list(self._unnamed)
        self._unnamed.clear()
        for since, participant, take in waiting:
            peer = self._peer(participant)
            if peer or now - since >= _AWAIT_NAME:
                take(peer or self._stranger(participant))
            else:
                self._unnamed.append((since, participant, take))

    def _nodes(self, participant: bytes) -> list[str]:
        """Return the nodes of a participant that are clients here."""
        return [node for end, node in self._named() if node and end.participant == participant]

    def _named(self) -> Iterator[tuple[Ros2Endpoint, str]]:
        """Yield the ends of clients here, each with its node."""
        for topic in self._topics:
            for end in self._graph.ends(topic).subscribers:
                yield end, self._approved.get(end.gid, end.node)

    def _may_keep(self, end: Ros2Endpoint, node: str) -> bool:
        return names_node(self._publisher, node) and self._owners.has(node, end.participant)

    def _peer(self, participant: bytes) -> Peer | None:
        """Return the sender, None while it may turn out to be approved.

        Of several nodes in one process it is the one that is approved here.
        """
        nodes = self._nodes(participant)
        approved = [node for node in nodes if names_node(self._publisher, node)]
        for node in approved:
            if self._owners.has(node, participant):
                return Peer(node, self._info)
        return self._stranger(participant) if nodes and not approved else None

    def _stranger(self, participant: bytes) -> Peer:
        """Return a sender that is not approved, or whose name is another's.

        Those without a name are told apart by their participants.
        """
        nodes = self._nodes(participant)
        name = next(iter(nodes), f"participant {participant.hex()}")
        return Peer(name, self._info, verified=False)
