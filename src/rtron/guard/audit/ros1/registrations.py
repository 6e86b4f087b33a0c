"""What the master's own list shows: strangers on private topics, and nodes without their remaps."""

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice

from rtron.guard.audit.common.guard_inputs import matches_any
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.core.printable import printable
from rtron.vocabulary import Alarm, AlarmKind
from rtron.wire.ros1.ros_api import NamedNode, SystemState

_MAX_PER_TOPIC = 16
MAX_NAME = 256
"""How much of a node's name counts, characters; a planned name is shorter."""

NodesByTopic = Mapping[str, frozenset[str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class MasterRegistrations:
    """Who publishes and subscribes what, as the master says; only topics of the plan."""

    publishers: NodesByTopic
    subscribers: NodesByTopic


def select_registrations(state: SystemState, topics: Container[str]) -> MasterRegistrations:
    """Return what a master's state says of these topics."""
    return MasterRegistrations(
        publishers=_nodes_by_topic(state.publishers, topics),
        subscribers=_nodes_by_topic(state.subscribers, topics),
    )


def foreign_publisher_alarms(
    state: MasterRegistrations, expected: ExpectedGraph
) -> Iterator[Alarm]:
    """Yield an alarm for each node that registered as publisher of a private topic, 16 at most."""
    for topic in expected.private_topics():
        listed = sorted(state.publishers.get(topic.topic, ()))
        foreign = (node for node in listed if not topic.may_publish(node))
        for node in islice(foreign, _MAX_PER_TOPIC):
            name = printable(node)
            reason = f"{name} registered as publisher of the private {topic.topic}"
            kind = AlarmKind.FOREIGN_PUBLISHER
            yield Alarm(kind=kind, reason=reason, topic=topic.topic, peer=name)


def drift_alarms(state: MasterRegistrations, expected: ExpectedGraph) -> Iterator[Alarm]:
    """Yield an alarm for each planned node that uses a public name instead of its private one."""
    for public, private in expected.outputs.items():
        for node in sorted(state.subscribers.get(public, ())):
            if node not in expected.guard_nodes and expected.topics[private].may_subscribe(node):
                yield _drift_alarm(node, public, f"{node} listens to {public}, not to {private}")
    for way in expected.inputs:
        for node in sorted(state.publishers.get(way.public, ())):
            if node not in expected.guard_nodes and matches_any(way.publishers, node):
                what = f"{node} publishes {way.public}, not {way.private}"
                yield _drift_alarm(node, way.public, what)


def guarded_subscribers(state: MasterRegistrations, expected: ExpectedGraph) -> frozenset[str]:
    """Return the nodes that the master lists as subscribers and that are guarded."""
    listed = (node for nodes in state.subscribers.values() for node in nodes)
    return frozenset(node for node in set(listed) if expected.audited_topics(node))


def _drift_alarm(node: str, topic: str, what: str) -> Alarm:
    reason = f"{what}: its remap is missing"
    return Alarm(kind=AlarmKind.DRIFT, reason=reason, topic=topic, node=node)


def _nodes_by_topic(registrations: Iterable[NamedNode], topics: Container[str]) -> NodesByTopic:
    nodes: dict[str, set[str]] = defaultdict(set)
    for topic, node in registrations:
        if topic in topics:
            nodes[topic].add(node[:MAX_NAME])
    return {topic: frozenset(names) for topic, names in nodes.items()}
