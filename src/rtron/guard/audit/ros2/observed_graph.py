"""What a ROS 2 domain says of itself at one moment: endpoints, nodes and services."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from rtron.guard.core.printable import shown
from rtron.vocabulary import Direction

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rtron.vocabulary import Service
    from rtron.wire.ros2.endpoints import Ros2Endpoint

EVERYBODY = "/rosout"
"""The topic that nearly every node publishes: it tells which participant a node lives in."""


class Seen:
    """Endpoints by topic; `nodes` has a name as often as it is there, since it need not be once."""

    def __init__(
        self,
        ends: Iterable[Ros2Endpoint],
        nodes: Sequence[str] = (),
        services: Sequence[Service] = (),
    ) -> None:
        self.ends = tuple(ends)
        self.nodes = tuple(nodes)
        self.services = tuple(services)
        self._by_topic: dict[tuple[str, Direction], list[Ros2Endpoint]] = defaultdict(list)
        self.participants: dict[str, set[bytes]] = defaultdict(set)
        """The participants that have each node name."""
        for end in self.ends:
            self._by_topic[end.topic, end.direction].append(end)
            if end.node:
                self.participants[end.node].add(end.participant)

    def publishers(self, topic: str) -> Sequence[Ros2Endpoint]:
        """Return who publishes a topic."""
        return self._by_topic.get((topic, Direction.PUBLISH), ())

    def subscribers(self, topic: str) -> Sequence[Ros2Endpoint]:
        """Return who subscribes a topic."""
        return self._by_topic.get((topic, Direction.SUBSCRIBE), ())


def told(end: Ros2Endpoint) -> str:
    """Return what to call an endpoint: its node, or its GID as long as the domain names none."""
    return shown(end.node) if end.node else f"GID {end.gid.hex()}"


def told_exactly(end: Ros2Endpoint) -> str:
    """Return what to call an endpoint whose node name somebody else has, too."""
    return f"{told(end)} of the participant {end.participant.hex()}"
