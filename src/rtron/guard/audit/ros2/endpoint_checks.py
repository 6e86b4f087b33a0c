"""Who speaks where the plan lets them not, and which planned nodes use the wrong name.

What counts is the participant: a node name is no proof of anything in ROS 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.guard.audit.ros1.expected_graph import is_open, meant
from rtron.guard.audit.ros2.expected_graph import is_service, spoken
from rtron.guard.audit.ros2.observed_graph import Seen, told, told_exactly
from rtron.guard.audit.ros2.qos_compatibility import misfit
from rtron.vocabulary import PlannedTopic, normalise_type

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtron.guard.audit.ros2.expected_graph import Wanted
    from rtron.wire.ros2.endpoints import Ros2Endpoint


Participants = frozenset[bytes]


def foreign(
    wanted: Wanted, seen: Seen, topic: PlannedTopic, ours: Participants
) -> tuple[Ros2Endpoint, ...]:
    """Return the publishers of a topic that the plan does not name, and those with our names.

    `ours` are the participants of the guard and of its supervisor.
    """
    if is_open(topic):
        return ()
    return tuple(
        end
        for end in seen.publishers(topic.topic)
        if end.participant not in ours
        and (end.node in wanted.own or not topic.may_publish(end.node))
    )


def heard_by(
    wanted: Wanted, seen: Seen, topics: tuple[PlannedTopic, ...], node: str, ours: Participants
) -> tuple[Ros2Endpoint, ...]:
    """Return whom a node hears past the guard, on those of the topics that it listens to."""
    return tuple(
        end
        for topic in topics
        if any(each.node == node for each in seen.subscribers(topic.topic))
        for end in foreign(wanted, seen, topic, ours)
    )


def named(wanted: Wanted, ends: Sequence[Ros2Endpoint]) -> tuple[str, ...]:
    """Return what to call strangers, each once; a name of ours goes with its participant."""
    called = (told_exactly(end) if end.node in wanted.own else told(end) for end in ends)
    return tuple(sorted(set(called)))


def unplanned_listeners(wanted: Wanted, seen: Seen, topic: PlannedTopic) -> tuple[str, ...]:
    """Return who listens to a topic and is not meant to."""
    ends = seen.subscribers(topic.topic)
    return tuple(
        sorted(
            {
                told(end)
                for end in ends
                if end.node not in wanted.own and not topic.may_subscribe(end.node)
            }
        )
    )


def deaf(
    wanted: Wanted, seen: Seen, topic: PlannedTopic, listener: Ros2Endpoint, ours: Participants
) -> str:
    """Return why a listener does not hear the guard on a topic, nothing if it does or may."""
    if is_service(topic.topic):
        return ""
    said = [end for end in seen.publishers(topic.topic) if end.participant in ours]
    reasons = [misfit(end, listener) for end in said]
    if not said:
        return _wrong_type(wanted, topic, listener)
    return "" if "" in reasons else reasons[0]


def unfit(wanted: Wanted, topic: PlannedTopic, speaker: Ros2Endpoint) -> str:
    """Return why the guard does not take what a planned publisher says, nothing if it does."""
    return "" if is_service(topic.topic) else _wrong_type(wanted, topic, speaker)


def strays(
    wanted: Wanted, ends: Sequence[Ros2Endpoint], patterns: tuple[str, ...]
) -> tuple[str, ...]:
    """Return the nodes among endpoints that a plan's patterns mean and that are not the guard's."""
    return tuple(
        sorted({e.node for e in ends if e.node not in wanted.own and meant(patterns, e.node)})
    )


def place(topic: PlannedTopic | str) -> str:
    """Return a topic's or a service's name as people know it."""
    return spoken(topic if isinstance(topic, str) else topic.topic)


def _wrong_type(wanted: Wanted, topic: PlannedTopic, end: Ros2Endpoint) -> str:
    planned, its = wanted.type_on(topic), normalise_type(end.type)
    return f"its type is {its}, the plan's is {planned}" if planned and its != planned else ""
