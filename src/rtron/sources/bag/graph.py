"""The InteractionGraph that a bag shows: who published what while it was recorded."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.sources.bag.common.reader import BagConnection, BagReader
from rtron.sources.bag.formats import open_bag
from rtron.sources.live.ros1.actions import ACTION_TOPICS, find_actions
from rtron.vocabulary import (
    Action,
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

_GOAL, _STATUS, _RESULT = "goal", "status", "result"
_GOAL_TYPE = "ActionGoal"
_STATUS_TYPE = "actionlib_msgs/GoalStatusArray"


def find_recorded_actions(endpoints: Sequence[Endpoint]) -> tuple[Action, ...]:
    """Return the actions among the endpoints.

    A recorded action often lacks the topics `cancel`, `feedback` or `result`, because nobody sent
    anything there. What is left shows its goal or its status by type; whoever publishes the status
    is the server (actionlib: DetailedDescription).
    """
    return tuple(dict.fromkeys(find_actions([*endpoints, *_unrecorded_topics(endpoints)])))


def _unrecorded_topics(endpoints: Sequence[Endpoint]) -> Iterator[Endpoint]:
    """Yield ends for the missing topics of what is an action by the type of its goal or status."""
    recorded = {each.topic for each in endpoints}
    for each in endpoints:
        namespace, _, part = each.topic.rpartition("/")
        is_status = part == _STATUS and each.type == _STATUS_TYPE
        if is_status:
            yield replace(each, topic=f"{namespace}/{_RESULT}", type="")
        if is_status or (part == _GOAL and each.type.endswith(_GOAL_TYPE)):
            missing = {f"{namespace}/{other}" for other in ACTION_TOPICS} - recorded
            for topic in sorted(missing):
                yield replace(each, topic=topic, type="", direction=Direction.SUBSCRIBE)


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
