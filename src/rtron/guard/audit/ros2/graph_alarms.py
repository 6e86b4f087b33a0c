"""The alarms that follow from what a ROS 2 domain shows, each with the streams that it goes past.

Pure. A stream is gone past where others than the guard rely on what a stranger says; what strangers
say to the guard alone is refused there, and told. Who offers to serve a guarded action goes past
it: who answers a request, ROS 2 does not say, so goals may be with others than the guard believes.
"""

from __future__ import annotations

from functools import partial
from itertools import islice
from typing import TYPE_CHECKING

from rtron.guard.audit.common.debounced_alarms import BrakingAlarm
from rtron.guard.audit.ros2.endpoint_checks import (
    Participants,
    display_name,
    foreign_publishers,
    matching_nodes,
    publication_problem,
    subscription_problem,
)
from rtron.guard.audit.ros2.observed_graph import endpoint_label
from rtron.guard.core.printable import printable
from rtron.vocabulary import (
    ROS2_ACTION_SERVICES,
    SECOND,
    Alarm,
    AlarmKind,
    Ros2ActionEntity,
    TopicAccess,
    output_topic,
    ros2_entity_name,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
    from rtron.guard.audit.ros2.observed_graph import ObservedGraph
    from rtron.guard.transport.ros2.participants import ParticipantLiveness
    from rtron.wire.ros2.endpoints import Ros2Endpoint

NAME_TIMEOUT = 5 * SECOND
"""How long the domain may take to name the node of an endpoint (ns); on a busy machine over 1 s."""
_MAX_PER_TOPIC = 16


def foreign_endpoint_alarms(
    expected: ExpectedGraph,
    observed: ObservedGraph,
    guard_participants: Participants,
    liveness: ParticipantLiveness,
    now: int,
) -> list[BrakingAlarm]:
    """Return who speaks where the plan lets them not, and who has a name of ours."""
    alarms = [*_name_takeovers(expected, observed, guard_participants)]
    for topic in _audited_topics(expected, observed):
        is_past_guard = _leads_past_guard(expected, topic)
        endpoints = (
            e
            for e in foreign_publishers(expected, observed, topic, guard_participants)
            if e.node not in expected.guard_nodes
        )
        named = (
            e
            for e in endpoints
            if e.node
            or (is_past_guard and liveness.has_process_ids)
            or _is_name_overdue(e, liveness, now)
        )
        is_server = not is_past_guard and _is_server_topic(expected, topic)
        make_alarm = (
            _rival_server_alarm
            if is_server
            else partial(_foreign_publisher_alarm, is_past_guard=is_past_guard)
        )
        alarms += [make_alarm(topic, endpoint) for endpoint in islice(named, _MAX_PER_TOPIC)]
    return alarms


def duplicate_name_alarms(
    expected: ExpectedGraph, observed: ObservedGraph, liveness: ParticipantLiveness, now: int
) -> list[BrakingAlarm]:
    """Return the planned nodes whose name several living participants have.

    Gone past are the actions that more than one of them offers to serve.
    """
    return [
        BrakingAlarm(
            _duplicate_name_alarm(node, liveness.not_ended(participants)),
            _doubly_served_actions(expected, observed, liveness, node),
        )
        for node, participants in sorted(observed.participants.items())
        if len(participants) > 1
        and expected.is_planned(node)
        and liveness.has_conflict(participants, now)
    ]


def drift_alarms(
    expected: ExpectedGraph, observed: ObservedGraph, guard_participants: Participants
) -> Iterator[Alarm]:
    """Yield an alarm for each planned node that uses a public name, or is not connected to us."""
    for public, private in expected.outputs.items():
        topic = expected.topics[private]
        for node in matching_nodes(expected, observed.subscribers(public), topic.subscribers):
            what = f"{node} listens to {display_name(public)}, not to {display_name(private)}"
            yield _drift_alarm(node, public, f"{what}: its remap is missing")
        for endpoint in observed.subscribers(private):
            why = _listener_problem(expected, observed, topic, endpoint, guard_participants)
            if why:
                yield _drift_alarm(endpoint.node, private, f"{endpoint.node} {why}")
    for guard_input in expected.inputs:
        for node in matching_nodes(
            expected, observed.publishers(guard_input.public), guard_input.publishers
        ):
            public, private = guard_input.public, guard_input.private
            what = f"{node} publishes {display_name(public)}, not {display_name(private)}"
            yield _drift_alarm(node, public, f"{what}: its remap is missing")
        topic = expected.topics[guard_input.private]
        for endpoint in observed.publishers(guard_input.private):
            why = (
                publication_problem(expected, topic, endpoint)
                if topic.may_publish(endpoint.node)
                else ""
            )
            if why and endpoint.participant not in guard_participants:
                yield _drift_alarm(
                    endpoint.node,
                    guard_input.private,
                    f"the guard does not hear {endpoint.node}: {why}",
                )


def _listener_problem(
    expected: ExpectedGraph,
    observed: ObservedGraph,
    topic: TopicAccess,
    endpoint: Ros2Endpoint,
    guard_participants: Participants,
) -> str:
    """Return what is wrong with a listener of a private output, nothing if it is a stranger."""
    if expected.is_in_cell(endpoint.node):
        return f"listens to {display_name(topic)} outside its cell"
    if not topic.may_subscribe(endpoint.node):
        return ""
    why = subscription_problem(expected, observed, topic, endpoint, guard_participants)
    return f"does not hear the guard: {why}" if why else ""


def _audited_topics(expected: ExpectedGraph, observed: ObservedGraph) -> Iterator[TopicAccess]:
    """Yield the private topics, and the public names to which a successor listens."""
    yield from expected.private_topics()
    for public, private in expected.outputs.items():
        if matching_nodes(
            expected, observed.subscribers(public), expected.topics[private].subscribers
        ):
            yield expected.topics[public]


def _is_name_overdue(endpoint: Ros2Endpoint, liveness: ParticipantLiveness, now: int) -> bool:
    """Tell whether an endpoint waits for its name for too long."""
    return now - liveness.since(endpoint.participant) > NAME_TIMEOUT


def _name_takeovers(
    expected: ExpectedGraph, observed: ObservedGraph, guard_participants: Participants
) -> Iterator[BrakingAlarm]:
    """Yield the participants that have a name of ours: what may be said by it is not trusted."""
    for node, participants in observed.participants.items():
        for participant in (
            sorted(participants - guard_participants) if node in expected.guard_nodes else ()
        ):
            who = participant.hex()
            reason = f"the participant {who} has taken the name {node}"
            bypassed = _bypassed_streams(expected, observed, node, participant)
            alarm = Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=node, peer=who)
            endpoints = observed.endpoints_of(participant)
            yield BrakingAlarm(alarm, tuple(sorted(bypassed)), endpoints)


def _bypassed_streams(
    expected: ExpectedGraph, observed: ObservedGraph, node: str, participant: bytes
) -> frozenset[str]:
    """Return the streams on which a name, not a pattern, may publish, and those gone past."""
    topics = [topic for topic in expected.topics.values() if node in topic.publishers]
    topics += [
        topic
        for topic in _audited_topics(expected, observed)
        if (_leads_past_guard(expected, topic) or _is_server_topic(expected, topic))
        and any(
            (each.node, each.participant) == (node, participant)
            for each in observed.publishers(topic.topic)
        )
    ]
    return frozenset(topic.stream_topic for topic in topics) - expected.celled


def _leads_past_guard(expected: ExpectedGraph, topic: TopicAccess) -> bool:
    """Tell whether others than the guard rely on what a stranger says on a topic."""
    return topic.stream_topic not in expected.celled and (
        expected.has_consumers_outside_guard(topic) or topic.topic in expected.outputs
    )


def _foreign_publisher_alarm(
    topic: TopicAccess, endpoint: Ros2Endpoint, *, is_past_guard: bool
) -> BrakingAlarm:
    kind = AlarmKind.FOREIGN_PUBLISHER if endpoint.node else AlarmKind.UNREGISTERED_PUBLISHER
    who = (
        f"{endpoint_label(endpoint)} of the participant {endpoint.participant.hex()}"
        if endpoint.node
        else endpoint_label(endpoint)
    )
    how = "past the guard" if is_past_guard else "where the guard does not hear it"
    reason = f"{who} publishes {display_name(topic)}, {how}"
    alarm = Alarm(
        kind=kind, reason=reason, topic=display_name(topic), peer=endpoint_label(endpoint)
    )
    streams = (topic.stream_topic,) if is_past_guard else ()
    return BrakingAlarm(alarm, streams, frozenset({endpoint.gid}))


def _rival_server_alarm(topic: TopicAccess, endpoint: Ros2Endpoint) -> BrakingAlarm:
    """Return the alarm of a second server: the same, of whichever of its ends."""
    kind = AlarmKind.FOREIGN_PUBLISHER if endpoint.node else AlarmKind.UNREGISTERED_PUBLISHER
    peer = printable(endpoint.node) or "a node without a name"
    who = f"{peer} of the participant {endpoint.participant.hex()}"
    reason = f"{who} offers to serve {topic.stream_topic}, too"
    alarm = Alarm(kind=kind, reason=reason, topic=output_topic(topic.stream_topic), peer=peer)
    return BrakingAlarm(alarm, (topic.stream_topic,), frozenset({endpoint.gid}))


def _is_server_topic(expected: ExpectedGraph, topic: TopicAccess) -> bool:
    """Tell whether who speaks on a topic is an action's server: it answers, or tells the status."""
    action = output_topic(topic.stream_topic)
    server_topics = {
        ros2_entity_name(action, part) for part in (*ROS2_ACTION_SERVICES, Ros2ActionEntity.STATUS)
    }
    return topic.stream_topic in expected.actions and display_name(topic) in server_topics


def _doubly_served_actions(
    expected: ExpectedGraph, observed: ObservedGraph, liveness: ParticipantLiveness, node: str
) -> tuple[str, ...]:
    """Return the actions whose status several living participants tell under one name."""
    found = []
    for action in sorted(expected.actions):
        endpoints = observed.publishers(
            ros2_entity_name(output_topic(action), Ros2ActionEntity.STATUS)
        )
        servers = {endpoint.participant for endpoint in endpoints if endpoint.node == node}
        found += [action] if len(liveness.not_ended(servers)) > 1 else []
    return tuple(found)


def _duplicate_name_alarm(node: str, participants: Participants) -> Alarm:
    who = ", ".join(each.hex() for each in sorted(participants)[:4])
    reason = f"{len(participants)} participants have the name {printable(node)}: {who}"
    return Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=printable(node), peer=who)


def _drift_alarm(node: str, topic: str, reason: str) -> Alarm:
    return Alarm(kind=AlarmKind.DRIFT, reason=reason, topic=display_name(topic), node=node)
