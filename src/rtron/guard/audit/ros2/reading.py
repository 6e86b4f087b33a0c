"""Reading a domain's graph through one of our nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from rtron.guard.audit.ros2.seen import Seen
from rtron.guard.audit.ros2.wanted import is_service
from rtron.vocabulary import Service

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from rtron.wire.ros2.endpoints import Ros2Endpoint

_MOST_NODES = 2000
_MOST_ENDS = 256


class Reader:
    """Asks what the domain has told our participant until now; nothing waits for anybody.

    `node` is rclpy's. Of each topic's publishers and subscribers, at most 256 each are read.
    """

    def __init__(self, node: Any) -> None:  # noqa: ANN401 - rclpy's stays in its rooms
        from rtron.wire.ros2.endpoints import (  # noqa: PLC0415 - only where ROS 2 is chosen
            publishers_of,
            subscribers_of,
        )

        self._node = node
        self._raw = cast("Any", _Raw(node))
        self._sides: tuple[Callable[[Any, str], list[Ros2Endpoint]], ...]
        self._sides = (publishers_of, subscribers_of)

    def seen(self, topics: Iterable[str]) -> Seen:
        """Return all there is: endpoints of these topics, every node, and every node's services."""
        nodes = self.nodes()
        return Seen(self.ends(topics), nodes, tuple(self._services(sorted(set(nodes)))))

    def ends(self, topics: Iterable[str]) -> Iterator[Ros2Endpoint]:
        """Yield the endpoints of topics, and of services by their middleware's names."""
        for topic in topics:
            node = self._raw if is_service(topic) else self._node
            for side in self._sides:
                yield from sorted(side(node, topic), key=lambda end: end.gid)[:_MOST_ENDS]

    def nodes(self) -> tuple[str, ...]:
        """Return every node's full name, as often as it is there."""
        listed: Sequence[tuple[str, str]] = self._node.get_node_names_and_namespaces()
        return tuple(f"{space.rstrip('/')}/{name}" for name, space in listed[:_MOST_NODES])

    def _services(self, nodes: Iterable[str]) -> Iterator[Service]:
        for node in nodes:
            space, _, name = node.rpartition("/")
            try:
                found = self._node.get_service_names_and_types_by_node(name, space or "/")
            except Exception:  # noqa: BLE001, S112 - it has just left; rclpy's kinds differ
                continue
            for service, types in found:
                yield from (Service(node=node, name=service, type=type) for type in types)


class _Raw:
    """A node that is asked for names as the middleware has them."""

    def __init__(self, node: Any) -> None:  # noqa: ANN401
        self._node = node

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        found: list[Any] = self._node.get_publishers_info_by_topic(topic, no_mangle=True)
        return found

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        found: list[Any] = self._node.get_subscriptions_info_by_topic(topic, no_mangle=True)
        return found
