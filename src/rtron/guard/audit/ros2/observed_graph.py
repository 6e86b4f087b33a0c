"""What a ROS 2 domain says of itself at one moment: endpoints, nodes and services."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from rtron.guard.core.printable import printable
from rtron.vocabulary import Direction

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rtron.vocabulary import Service
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


def endpoint_label(endpoint: Ros2Endpoint) -> str:
    """Return what to call an endpoint: its node, or its GID as long as the domain names none."""
    return printable(endpoint.node) if endpoint.node else f"GID {endpoint.gid.hex()}"


def endpoint_label_with_participant(endpoint: Ros2Endpoint) -> str:
    """Return what to call an endpoint whose node name somebody else has, too."""
    return f"{endpoint_label(endpoint)} of the participant {endpoint.participant.hex()}"
