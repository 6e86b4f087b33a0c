"""Whose a request is: a node of the participant that sent it, as the graph tells.

A client of an action also subscribes its topics (rcl_action), so the graph names its node there.
Once that is an approved name of its own there, it stays: no endpoint changes its node, and anybody
can tell the domain another name for it.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import ROS2_ACTION_TOPICS, SECOND, matches_node, ros2_entity_name
from rtron.wire.ros2.endpoints import PARTICIPANT_SIZE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtron.guard.transport.ros2.context import TransportContext
    from rtron.wire.ros2.endpoints import Ros2Endpoint

    PeerHandler = Callable[[Peer], None]

_NAME_TIMEOUT = SECOND
_MAX_UNRESOLVED = 256
_MAX_PER_PARTICIPANT = 32


class ClientResolver:
    """Names the senders of requests under one name of an action; the nameless wait a moment."""

    def __init__(
        self, action: str, publisher: str, info: TypeInfo, context: TransportContext
    ) -> None:
        self._topics = [ros2_entity_name(action, end) for end in ROS2_ACTION_TOPICS]
        self._publisher = publisher
        self._info = info
        self._graph = context.graph
        self._loop = context.loop
        self._owners = context.owners
        self._unresolved: deque[tuple[int, bytes, PeerHandler]] = deque()
        self._approved: dict[bytes, str] = {}
        for topic in self._topics:
            self._graph.watch(topic)
        self._graph.listeners.append(self.update)

    def close(self) -> None:
        """Name nobody any more."""
        self._graph.listeners.remove(self.update)

    def resolve(self, request_id: bytes, on_peer: PeerHandler) -> None:
        """Call `on_peer` with the sender of a request, now or when the graph knows it."""
        participant = request_id[:PARTICIPANT_SIZE]
        peer = self._peer(participant)
        if peer or self._is_full(participant):
            on_peer(peer or self._unapproved_peer(participant))
        else:
            self._unresolved.append((self._loop.now(), participant, on_peer))
            for topic in self._topics:
                self._graph.query_if_due(topic)

    def _is_full(self, participant: bytes) -> bool:
        """Tell whether no more may wait, of all or of one: it shall not crowd out the others."""
        own_count = sum(each == participant for _, each, _ in self._unresolved)
        return own_count >= _MAX_PER_PARTICIPANT or len(self._unresolved) >= _MAX_UNRESOLVED

    def update(self) -> None:
        """Take what the graph says: name who has waited for it, or waited for too long."""
        self._approved = {
            end.gid: node for end, node in self._clients() if self._is_approved_client(end, node)
        }
        now, unresolved = self._loop.now(), list(self._unresolved)
        self._unresolved.clear()
        for since, participant, on_peer in unresolved:
            peer = self._peer(participant)
            if peer or now - since >= _NAME_TIMEOUT:
                on_peer(peer or self._unapproved_peer(participant))
            else:
                self._unresolved.append((since, participant, on_peer))

    def _nodes(self, participant: bytes) -> list[str]:
        """Return the nodes of a participant that are clients here."""
        return [node for end, node in self._clients() if node and end.participant == participant]

    def _clients(self) -> Iterator[tuple[Ros2Endpoint, str]]:
        """Yield the ends of clients here, each with its node."""
        for topic in self._topics:
            for end in self._graph.endpoints(topic).subscribers:
                yield end, self._approved.get(end.gid, end.node)

    def _is_approved_client(self, end: Ros2Endpoint, node: str) -> bool:
        return matches_node(self._publisher, node) and self._owners.is_owner(node, end.participant)

    def _peer(self, participant: bytes) -> Peer | None:
        """Return the sender, None while it may turn out to be approved.

        Of several nodes in one process it is the one that is approved here.
        """
        nodes = self._nodes(participant)
        approved = [node for node in nodes if matches_node(self._publisher, node)]
        for node in approved:
            if self._owners.is_owner(node, participant):
                return Peer(node, self._info)
        return self._unapproved_peer(participant) if nodes and not approved else None

    def _unapproved_peer(self, participant: bytes) -> Peer:
        """Return a sender that is not approved, or whose name is another's.

        Those without a name are told apart by their participants.
        """
        nodes = self._nodes(participant)
        name = next(iter(nodes), f"participant {participant.hex()}")
        return Peer(name, self._info, verified=False)
