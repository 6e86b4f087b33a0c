"""Who speaks where the plan lets them not, and which planned nodes use the wrong name.

What counts is the participant: a node name is no proof of anything in ROS 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.common.guard_inputs import allows_anybody, matches_any
from rtron.guard.audit.ros2.observed_graph import (
    ObservedGraph,
    endpoint_label,
    endpoint_label_with_participant,
)
from rtron.vocabulary import (
    Direction,
    Durability,
    Liveliness,
    QoS,
    Reliability,
    TopicAccess,
    normalise_type,
)
from rtron.wire.ros2.service_names import is_service_topic, ros_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
    from rtron.wire.ros2.endpoints import Ros2Endpoint


def incompatibility(publisher: Ros2Endpoint, subscriber: Ros2Endpoint) -> str:
    """Return why a subscriber does not hear a publisher, nothing if it does."""
    published_type, subscribed_type = (
        normalise_type(publisher.type),
        normalise_type(subscriber.type),
    )
    if published_type != subscribed_type:
        return f"{published_type} is published, {subscribed_type} is asked for"
    return ", ".join(qos_incompatibilities(publisher.qos, subscriber.qos))


def qos_incompatibilities(offered: QoS, requested: QoS) -> Iterator[str]:
    """Yield each quality that is asked for and not offered."""
    if offered.reliability is not requested.reliability is Reliability.RELIABLE:
        yield "reliable is asked for, best effort is offered"
    if offered.durability is not requested.durability is Durability.TRANSIENT_LOCAL:
        yield "transient local is asked for, volatile is offered"
    if offered.liveliness is not requested.liveliness is Liveliness.MANUAL_BY_TOPIC:
        yield "liveliness by topic is asked for, automatic is offered"
    yield from _duration_incompatibility("deadline", offered.deadline, requested.deadline)
    yield from _duration_incompatibility("lease of the liveliness", offered.lease, requested.lease)


def _duration_incompatibility(what: str, offered: int, requested: int) -> Iterator[str]:
    """Yield a clash of durations (ns, 0 for ever): at most what is asked for must be offered."""
    if requested and (not offered or offered > requested):
        limit = f"{offered / 1e6:g} ms" if offered else "none"
        yield f"a {what} of {requested / 1e6:g} ms is asked for, {limit} is offered"


Participants = frozenset[bytes]


def foreign_publishers(
    expected: ExpectedGraph,
    observed: ObservedGraph,
    topic: TopicAccess,
    guard_participants: Participants,
) -> tuple[Ros2Endpoint, ...]:
    """Return the publishers of a topic that the plan does not name, and those with our names.

    `guard_participants` are the participants of the guard and of its supervisor.
    """
    if allows_anybody(topic):
        return ()
    return tuple(
        endpoint
        for endpoint in observed.publishers(topic.topic)
        if endpoint.participant not in guard_participants
        and (endpoint.node in expected.guard_nodes or not topic.may_publish(endpoint.node))
    )


def planned_publishers(
    expected: ExpectedGraph, observed: ObservedGraph, guard_participants: Participants
) -> frozenset[bytes]:
    """Return the GIDs of the publishers that the plan names, and of all endpoints of the guard."""
    return frozenset(
        endpoint.gid
        for endpoint in observed.endpoints
        if endpoint.participant in guard_participants
        or _is_planned_publisher(
            expected.topics.get(endpoint.topic), endpoint, expected.guard_nodes
        )
    )


def _is_planned_publisher(
    topic: TopicAccess | None, endpoint: Ros2Endpoint, guard_nodes: frozenset[str]
) -> bool:
    return bool(
        topic
        and endpoint.node
        and endpoint.direction is Direction.PUBLISH
        and not allows_anybody(topic)
        and endpoint.node not in guard_nodes
        and topic.may_publish(endpoint.node)
    )


def foreign_sources(
    expected: ExpectedGraph,
    observed: ObservedGraph,
    topics: tuple[TopicAccess, ...],
    node: str,
    guard_participants: Participants,
) -> tuple[Ros2Endpoint, ...]:
    """Return whom a node hears past the guard, on those of the topics that it listens to."""
    return tuple(
        endpoint
        for topic in topics
        if any(each.node == node for each in observed.subscribers(topic.topic))
        for endpoint in foreign_publishers(expected, observed, topic, guard_participants)
    )


def endpoint_labels(expected: ExpectedGraph, endpoints: Sequence[Ros2Endpoint]) -> tuple[str, ...]:
    """Return what to call strangers, each once; a name of ours goes with its participant."""
    labels = (
        endpoint_label_with_participant(endpoint)
        if endpoint.node in expected.guard_nodes
        else endpoint_label(endpoint)
        for endpoint in endpoints
    )
    return tuple(sorted(set(labels)))


def unplanned_subscribers(
    expected: ExpectedGraph, observed: ObservedGraph, topic: TopicAccess
) -> tuple[str, ...]:
    """Return who listens to a topic and is not meant to."""
    endpoints = observed.subscribers(topic.topic)
    return tuple(
        sorted(
            {
                endpoint_label(endpoint)
                for endpoint in endpoints
                if endpoint.node not in expected.guard_nodes
                and not topic.may_subscribe(endpoint.node)
            }
        )
    )


def subscription_problem(
    expected: ExpectedGraph,
    observed: ObservedGraph,
    topic: TopicAccess,
    subscriber: Ros2Endpoint,
    guard_participants: Participants,
) -> str:
    """Return why a listener does not hear the guard on a topic, nothing if it does or may."""
    if is_service_topic(topic.topic):
        return ""
    publishers = [
        endpoint
        for endpoint in observed.publishers(topic.topic)
        if endpoint.participant in guard_participants
    ]
    reasons = [incompatibility(endpoint, subscriber) for endpoint in publishers]
    if not publishers:
        return _type_problem(expected, topic, subscriber)
    return "" if "" in reasons else reasons[0]


def publication_problem(
    expected: ExpectedGraph, topic: TopicAccess, publisher: Ros2Endpoint
) -> str:
    """Return why the guard does not take what a planned publisher says, nothing if it does."""
    return "" if is_service_topic(topic.topic) else _type_problem(expected, topic, publisher)


def matching_nodes(
    expected: ExpectedGraph, endpoints: Sequence[Ros2Endpoint], patterns: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the nodes among endpoints that a plan's patterns mean and that are not the guard's."""
    return tuple(
        sorted(
            {
                e.node
                for e in endpoints
                if e.node not in expected.guard_nodes and matches_any(patterns, e.node)
            }
        )
    )


def display_name(topic: TopicAccess | str) -> str:
    """Return a topic's or a service's name as people know it."""
    return ros_name(topic if isinstance(topic, str) else topic.topic)


def _type_problem(expected: ExpectedGraph, topic: TopicAccess, endpoint: Ros2Endpoint) -> str:
    planned, actual = expected.planned_type(topic), normalise_type(endpoint.type)
    return f"its type is {actual}, the plan's is {planned}" if planned and actual != planned else ""
