"""What the master's own list shows: strangers on private topics, and nodes without their remaps."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rtron.errors import WireError
from rtron.guard.audit.common.guard_inputs import matches_any
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.core.printable import printable
from rtron.vocabulary import Alarm, AlarmKind

_STATE_PARTS = 3
NodesByTopic = Mapping[str, frozenset[str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class MasterRegistrations:
    """Who publishes and subscribes what, as the master says; only topics of the plan."""

    publishers: NodesByTopic
    subscribers: NodesByTopic


def parse_registrations(answer: object, topics: Mapping[str, object]) -> MasterRegistrations:
    """Read getSystemState's value; malformed rows are left out, WireError if it is no state."""
    if not isinstance(answer, list) or len(answer) != _STATE_PARTS:
        raise WireError("the system state is not three lists")
    publishers, subscribers = (dict(_rows(side, topics)) for side in answer[:2])
    return MasterRegistrations(publishers=publishers, subscribers=subscribers)


def foreign_publisher_alarms(
    state: MasterRegistrations, expected: ExpectedGraph
) -> Iterator[Alarm]:
    """Yield an alarm for each node that registered as publisher of a private topic."""
    for topic in expected.private_topics():
        for node in sorted(state.publishers.get(topic.topic, ())):
            if not topic.may_publish(node):
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


def _rows(side: object, topics: Mapping[str, object]) -> Iterator[tuple[str, frozenset[str]]]:
    rows: Sequence[object] = side if isinstance(side, list) else ()
    for row in rows:
        if isinstance(row, list) and len(row) == 2:  # noqa: PLR2004 - a name and its nodes
            topic, nodes = row
            if isinstance(topic, str) and topic in topics and isinstance(nodes, list):
                yield topic, frozenset(node for node in nodes if isinstance(node, str) and node)
