"""The client of a request: a node of the participant that sent it, by the graph.

A client of an action also subscribes to the action's topics (rcl_action), so the graph names its
node there. Once that is an approved name which the participant owns, it stays: no endpoint changes
its node, and anybody can announce another name for it.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import Peer, TypeInfo
from rtron.vocabulary import ROS2_ACTION_TOPICS, SECOND, matches_node, ros2_entity_name
from rtron.wire.ros2.c_structures import GID_SIZE
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
    """Names the clients of an action's requests; requests without a name yet wait a moment."""

    def __init__(
        self, action: str, publisher: str, info: TypeInfo, context: TransportContext
    ) -> None:
        self._topics = [ros2_entity_name(action, name) for name in ROS2_ACTION_TOPICS]
        self._publisher = publisher
        self._info = info
        self._graph = context.graph
        self._loop = context.loop
        self._owners = context.owners
        self._sender_ids = context.sender_ids
        self._unresolved: deque[tuple[int, bytes, PeerHandler]] = deque()
        self._approved: dict[bytes, str] = {}
        for topic in self._topics:
            self._graph.watch(topic)
        self._graph.listeners.append(self.update)

    def close(self) -> None:
        """Stop resolving."""
        self._graph.listeners.remove(self.update)

    def resolve(self, request_id: bytes, on_peer: PeerHandler) -> None:
        """Call `on_peer` with the client of a request, now or once the graph knows it."""
        gid = request_id[:GID_SIZE]
        participant = gid[:PARTICIPANT_SIZE]
        peer = self._peer(participant)
        if peer or self._is_full(participant):
            on_peer(peer or self._unapproved_peer(participant))
        else:
            self._unresolved.append((self._loop.now(), gid, on_peer))
            for topic in self._topics:
                self._graph.query_if_due(topic)

    def _is_full(self, participant: bytes) -> bool:
        """Return whether no more requests may wait, in all or of this participant."""
        own_count = sum(gid.startswith(participant) for _, gid, _ in self._unresolved)
        return own_count >= _MAX_PER_PARTICIPANT or len(self._unresolved) >= _MAX_UNRESOLVED

    def update(self) -> None:
        """Take the new graph: name the clients that it knows now, or that have waited too long."""
        self._approved = {
            endpoint.gid: node
            for endpoint, node in self._clients()
            if self._is_approved_client(endpoint, node)
        }
        now, unresolved = self._loop.now(), list(self._unresolved)
        self._unresolved.clear()
        for since, gid, on_peer in unresolved:
            participant = self._sender_ids.gid(gid)[:PARTICIPANT_SIZE]
            peer = self._peer(participant)
            if peer or now - since >= _NAME_TIMEOUT:
                on_peer(peer or self._unapproved_peer(participant))
            else:
                self._unresolved.append((since, gid, on_peer))

    def _nodes(self, participant: bytes) -> list[str]:
        """Return the nodes of a participant that are clients of the action."""
        return [
            node
            for endpoint, node in self._clients()
            if node and endpoint.participant == participant
        ]

    def _clients(self) -> Iterator[tuple[Ros2Endpoint, str]]:
        """Yield the endpoints of the action's clients, each with its node."""
        for topic in self._topics:
            for endpoint in self._graph.endpoints(topic).subscribers:
                yield endpoint, self._approved.get(endpoint.gid, endpoint.node)

    def _is_approved_client(self, endpoint: Ros2Endpoint, node: str) -> bool:
        is_owner = self._owners.is_owner(node, endpoint.participant)
        return is_owner and matches_node(self._publisher, node)

    def _peer(self, participant: bytes) -> Peer | None:
        """Return the client, None while it may turn out to be approved.

        Of several nodes in one participant it is the approved one.
        """
        nodes = self._nodes(participant)
        approved = [node for node in nodes if matches_node(self._publisher, node)]
        for node in approved:
            if self._owners.is_owner(node, participant):
                return Peer(node, self._info)
        return self._unapproved_peer(participant) if nodes and not approved else None

    def _unapproved_peer(self, participant: bytes) -> Peer:
        """Return a client that is not approved, or whose name another participant owns.

        Clients without a name are named by their participants.
        """
        nodes = self._nodes(participant)
        name = next(iter(nodes), f"participant {participant.hex()}")
        return Peer(name, self._info, verified=False)
