"""Reading a domain's graph through one of our nodes."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from rtron.guard.audit.ros2.expected_graph import is_service_topic
from rtron.guard.audit.ros2.observed_graph import ObservedGraph
from rtron.vocabulary import Direction, Service

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rtron.wire.ros2.endpoints import Ros2Endpoint

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
