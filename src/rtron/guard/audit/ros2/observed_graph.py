"""What a ROS 2 domain says of itself at one moment: endpoints, nodes and services."""

from __future__ import annotations

import logging
from collections import defaultdict
from typing import TYPE_CHECKING, Any

from rtron.guard.core.printable import printable
from rtron.vocabulary import Direction, Service
from rtron.wire.ros2.service_names import is_service_topic

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from rtron.wire.ros2.endpoints import Ros2Endpoint


ROSOUT_TOPIC = "/rosout"
"""The topic that nearly every node publishes: it tells which participant a node lives in."""


class ObservedGraph:
    """Endpoints by topic; `nodes` has a name as often as it is there, since it need not be once."""

    def __init__(
        self,
        endpoints: Iterable[Ros2Endpoint],
        nodes: Sequence[str] = (),
        services: Sequence[Service] = (),
    ) -> None:
        self.endpoints = tuple(endpoints)
        self.nodes = tuple(nodes)
        self.services = tuple(services)
        self._by_topic: dict[tuple[str, Direction], list[Ros2Endpoint]] = defaultdict(list)
        self.participants: dict[str, set[bytes]] = defaultdict(set)
        """The participants that have each node name."""
        for endpoint in self.endpoints:
            self._by_topic[endpoint.topic, endpoint.direction].append(endpoint)
            if endpoint.node:
                self.participants[endpoint.node].add(endpoint.participant)

    def publishers(self, topic: str) -> Sequence[Ros2Endpoint]:
        """Return who publishes a topic."""
        return self._by_topic.get((topic, Direction.PUBLISH), ())

    def subscribers(self, topic: str) -> Sequence[Ros2Endpoint]:
        """Return who subscribes a topic."""
        return self._by_topic.get((topic, Direction.SUBSCRIBE), ())

    def endpoints_of(self, participant: bytes) -> frozenset[bytes]:
        """Return the GIDs of a participant's endpoints."""
        return frozenset(
            endpoint.gid for endpoint in self.endpoints if endpoint.participant == participant
        )

    def without(self, gids: Collection[bytes]) -> ObservedGraph:
        """Return the same without some endpoints."""
        others = (each for each in self.endpoints if each.gid not in gids)
        return ObservedGraph(others, self.nodes, self.services)


def endpoint_label(endpoint: Ros2Endpoint) -> str:
    """Return what to call an endpoint: its node, or its GID as long as the domain names none."""
    return printable(endpoint.node) if endpoint.node else f"GID {endpoint.gid.hex()}"


def endpoint_label_with_participant(endpoint: Ros2Endpoint) -> str:
    """Return what to call an endpoint whose node name somebody else has, too."""
    return f"{endpoint_label(endpoint)} of the participant {endpoint.participant.hex()}"


log = logging.getLogger(__name__)

_MAX_NODES = 2000


class GraphReader:
    """Asks what the domain has told our participant until now; nothing waits for anybody.

    `node` is rclpy's. Of each topic's publishers and subscribers, at most 256 each are read.
    """

    def __init__(self, node: Any) -> None:  # noqa: ANN401 - rclpy's stays in its rooms
        from rtron.guard.transport.ros2.graph_query import (  # noqa: PLC0415 - only with ROS 2
            GraphQuery,
        )

        self._node = node
        self._topic_listing, self._raw_listing = GraphQuery(node), GraphQuery(node, raw=True)
        self._known: dict[tuple[str, Direction], tuple[Ros2Endpoint, ...]] = {}

    def snapshot(self, topics: Iterable[str]) -> ObservedGraph:
        """Return all there is: endpoints of these topics, every node, and every node's services."""
        nodes = self.nodes()
        return ObservedGraph(
            self.endpoints(topics), nodes, tuple(self._services(sorted(set(nodes))))
        )

    def endpoints(self, topics: Iterable[str]) -> Iterator[Ros2Endpoint]:
        """Yield the endpoints of topics, and of services by their middleware's names."""
        for topic in topics:
            listing = self._raw_listing if is_service_topic(topic) else self._topic_listing
            for side in Direction:
                known = self._known.get((topic, side), ())
                self._known[topic, side] = listing.endpoints(topic, side, known)
                yield from self._known[topic, side]

    def nodes(self) -> tuple[str, ...]:
        """Return every node's full name, as often as it is there."""
        listed: Sequence[tuple[str, str]] = self._node.get_node_names_and_namespaces()
        return tuple(f"{space.rstrip('/')}/{name}" for name, space in listed[:_MAX_NODES])

    def _services(self, nodes: Iterable[str]) -> Iterator[Service]:
        for node in nodes:
            space, _, name = node.rpartition("/")
            try:
                found = self._node.get_service_names_and_types_by_node(name, space or "/")
            except Exception as error:  # noqa: BLE001 - it has just left; rclpy's kinds differ
                log.debug("the services of %s are not told: %s", node, error)
                continue
            for service, types in found:
                yield from (Service(node=node, name=service, type=type) for type in types)
