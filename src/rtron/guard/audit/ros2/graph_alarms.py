"""The alarms that follow from what a ROS 2 domain shows, each with the streams that it goes past.

Pure. A stream is gone past where others than the guard rely on what a stranger says; what strangers
say to the guard alone is refused there, and told. Who offers to serve a guarded action goes past
it: who answers a request, ROS 2 does not say, so goals may be with others than the guard believes.
"""

from __future__ import annotations

from functools import partial
from itertools import islice
from typing import TYPE_CHECKING

from rtron.guard.audit.ros2.endpoint_checks import (
    Participants,
    deaf,
    foreign,
    place,
    strays,
    unfit,
)
from rtron.guard.audit.ros2.observed_graph import told
from rtron.guard.core.printable import shown
from rtron.vocabulary import (
    REQUESTED,
    SECOND,
    ActionEnd,
    Alarm,
    AlarmKind,
    PlannedTopic,
    end_name,
    output_topic,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.ros2.expected_graph import Wanted
    from rtron.guard.audit.ros2.observed_graph import Seen
    from rtron.guard.transport.ros2.participants import Lives
    from rtron.wire.ros2.endpoints import Ros2Endpoint

AWAIT_NAME = 5 * SECOND
"""How long the domain may take to name the node of an endpoint (ns); on a busy machine over 1 s."""
_MOST_AT_A_TOPIC = 16

Case = tuple[Alarm, tuple[str, ...]]
"""An alarm, and the public names of the streams that are gone past."""


def strangers(wanted: Wanted, seen: Seen, ours: Participants, lives: Lives, now: int) -> list[Case]:
    """Return who speaks where the plan lets them not, and who has a name of ours."""
    found = [*_taken(wanted, seen, ours)]
    for topic in _spoken_on(wanted, seen):
        passes = wanted.leaves_guard(topic) or topic.topic in wanted.outputs
        ends = (e for e in foreign(wanted, seen, topic, ours) if e.node not in wanted.own)
        known = (e for e in ends if e.node or (passes and lives.tells) or _waited(e, lives, now))
        serves = not passes and _is_servers(wanted, topic)
        said = _rival if serves else partial(_stranger, passes=passes)
        found += [said(topic, end) for end in islice(known, _MOST_AT_A_TOPIC)]
    return found


def doubles(wanted: Wanted, seen: Seen, lives: Lives, now: int) -> list[Case]:
    """Return the planned nodes whose name several living participants have.

    Gone past are the actions that more than one of them offers to serve.
    """
    return [
        (_double(node, lives.living(participants)), _served_twice(wanted, seen, lives, node))
        for node, participants in sorted(seen.participants.items())
        if len(participants) > 1 and wanted.plans(node) and lives.clash(participants, now)
    ]


def drifts(wanted: Wanted, seen: Seen, ours: Participants) -> Iterator[Alarm]:
    """Yield an alarm for each planned node that uses a public name, or is not connected to us."""
    for public, private in wanted.outputs.items():
        topic = wanted.topics[private]
        for node in strays(wanted, seen.subscribers(public), topic.subscribers):
            what = f"{node} listens to {place(public)}, not to {place(private)}"
            yield _drift(node, public, f"{what}: its remap is missing")
        for end in seen.subscribers(private):
            why = deaf(wanted, seen, topic, end, ours) if topic.may_subscribe(end.node) else ""
            if why:
                yield _drift(end.node, private, f"{end.node} does not hear the guard: {why}")
    for way in wanted.entrances:
        for node in strays(wanted, seen.publishers(way.public), way.publishers):
            what = f"{node} publishes {place(way.public)}, not {place(way.private)}"
            yield _drift(node, way.public, f"{what}: its remap is missing")
        topic = wanted.topics[way.private]
        for end in seen.publishers(way.private):
            why = unfit(wanted, topic, end) if topic.may_publish(end.node) else ""
            if why and end.participant not in ours:
                yield _drift(end.node, way.private, f"the guard does not hear {end.node}: {why}")


def _spoken_on(wanted: Wanted, seen: Seen) -> Iterator[PlannedTopic]:
    """Yield the private topics, and the public names to which a successor listens."""
    yield from wanted.private()
    for public, private in wanted.outputs.items():
        if strays(wanted, seen.subscribers(public), wanted.topics[private].subscribers):
            yield wanted.topics[public]


def _waited(end: Ros2Endpoint, lives: Lives, now: int) -> bool:
    """Tell whether an endpoint waits for its name for too long."""
    return now - lives.since(end.participant) > AWAIT_NAME


def _taken(wanted: Wanted, seen: Seen, ours: Participants) -> Iterator[Case]:
    """Yield the participants that have a name of ours: what may be said by it is not trusted."""
    for node, participants in seen.participants.items():
        for participant in sorted(participants - ours) if node in wanted.own else ():
            who = participant.hex()
            reason = f"the participant {who} has taken the name {node}"
            topics = wanted.topics.values()
            past = {topic.guarded for topic in topics if topic.may_publish(node)}
            alarm = Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=node, peer=who)
            yield alarm, tuple(sorted(past))


def _stranger(topic: PlannedTopic, end: Ros2Endpoint, *, passes: bool) -> Case:
    kind = AlarmKind.FOREIGN_PUBLISHER if end.node else AlarmKind.GHOST
    who = f"{told(end)} of the participant {end.participant.hex()}" if end.node else told(end)
    how = "past the guard" if passes else "where the guard does not hear it"
    reason = f"{who} publishes {place(topic)}, {how}"
    alarm = Alarm(kind=kind, reason=reason, topic=place(topic), peer=told(end))
    return alarm, (topic.guarded,) if passes else ()


def _rival(topic: PlannedTopic, end: Ros2Endpoint) -> Case:
    """Return the alarm of a second server: the same, of whichever of its ends."""
    kind = AlarmKind.FOREIGN_PUBLISHER if end.node else AlarmKind.GHOST
    peer = shown(end.node) or "a node without a name"
    reason = (
        f"{peer} of the participant {end.participant.hex()} offers to serve {topic.guarded}, too"
    )
    alarm = Alarm(kind=kind, reason=reason, topic=output_topic(topic.guarded), peer=peer)
    return alarm, (topic.guarded,)


def _is_servers(wanted: Wanted, topic: PlannedTopic) -> bool:
    """Tell whether who speaks on a topic is an action's server: it answers, or tells the status."""
    action = output_topic(topic.guarded)
    spoken = {end_name(action, end) for end in (*REQUESTED, ActionEnd.STATUS)}
    return topic.guarded in wanted.actions and place(topic) in spoken


def _served_twice(wanted: Wanted, seen: Seen, lives: Lives, node: str) -> tuple[str, ...]:
    """Return the actions whose status several living participants tell under one name."""
    found = []
    for action in sorted(wanted.actions):
        ends = seen.publishers(end_name(output_topic(action), ActionEnd.STATUS))
        servers = {end.participant for end in ends if end.node == node}
        found += [action] if len(lives.living(servers)) > 1 else []
    return tuple(found)


def _double(node: str, participants: Participants) -> Alarm:
    who = ", ".join(each.hex() for each in sorted(participants)[:4])
    reason = f"{len(participants)} participants have the name {shown(node)}: {who}"
    return Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, node=shown(node), peer=who)


def _drift(node: str, topic: str, reason: str) -> Alarm:
    return Alarm(kind=AlarmKind.DRIFT, reason=reason, topic=place(topic), node=node)
