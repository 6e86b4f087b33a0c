"""The InteractionGraph that a bag shows: who published what while it was recorded."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rtron.sources.bag.common.reader import BagConnection, BagReader
from rtron.sources.bag.formats import open_bag
from rtron.sources.bag.silent_actions import find_recorded_actions
from rtron.vocabulary import (
    Direction,
    Durability,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    QoS,
    Resolution,
    Topic,
    UnresolvedItem,
)

_LOG_TOPICS = frozenset({"/rosout", "/rosout_agg"})
_LATCHED_QOS = QoS(durability=Durability.TRANSIENT_LOCAL)


@dataclass(frozen=True, slots=True)
class BagSource:
    """A Source that reads a bag's index: a ROS 1 .bag, a .mcap, a .db3, or a ROS 2 bag's folder.

    A topic whose publisher the bag does not name (ROS 2 never does) has no endpoint, since no node
    is invented for it. Latching reads as ROS 2's transient local durability.
    """

    path: Path

    def read(self) -> InteractionGraph:
        """Return the graph of what was recorded; InputError if the bag cannot be read."""
        reader = open_bag(self.path)
        evidence = (Evidence(file=str(self.path)),)
        endpoints = tuple(dict.fromkeys(_endpoints(reader.connections, evidence)))
        return InteractionGraph(
            app=self.path.resolve().name,
            ros=1 if any(each.encoding == "ros1" for each in reader.connections) else 2,
            nodes=tuple(Node(name=name) for name in dict.fromkeys(e.node for e in endpoints)),
            topics=_topics(reader.connections),
            endpoints=endpoints,
            actions=find_recorded_actions(endpoints),
            unresolved=tuple(_unresolved(reader, evidence)),
        )


def _endpoints(
    connections: Iterable[BagConnection], evidence: tuple[Evidence, ...]
) -> Iterator[Endpoint]:
    for each in connections:
        if each.callerid:
            yield Endpoint(
                node=each.callerid,
                topic=each.topic,
                direction=Direction.PUBLISH,
                type=each.type,
                implicit=each.topic in _LOG_TOPICS,
                resolution=Resolution.OBSERVED,
                qos=_LATCHED_QOS if each.latching else None,
                evidence=evidence,
            )


def _topics(connections: Iterable[BagConnection]) -> tuple[Topic, ...]:
    types: dict[str, dict[str, None]] = {}
    for each in connections:
        types.setdefault(each.topic, {})[each.type] = None
    return tuple(
        Topic(name=name, types=tuple(filter(None, used))) for name, used in sorted(types.items())
    )


def _unresolved(reader: BagReader, evidence: tuple[Evidence, ...]) -> Iterator[UnresolvedItem]:
    why = "a bag records who publishes, not who subscribes: read the app's launch files for that"
    yield UnresolvedItem(what="subscribers", why=why, evidence=evidence)
    unnamed = {each.topic: each for each in reader.connections if not each.callerid}
    for topic, connection in sorted(unnamed.items()):
        yield UnresolvedItem(what=topic, why=_unnamed_publisher(connection), evidence=evidence)
    for topic, why in reader.skipped:
        yield UnresolvedItem(what=topic, why=why, evidence=evidence)


def _unnamed_publisher(connection: BagConnection) -> str:
    number = len(connection.offered_qos)
    known = f", only that there were {number}" if number > 1 else ""
    return f"the bag does not name its publisher{'s' if known else ''}{known}"
