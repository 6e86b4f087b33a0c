"""A reader that starts later never learns a latched state.

## What it finds

In ROS 2 a node publishes a state that others act on (a stop, a lock, a mode, a map) once or on
change, as transient local, and another node subscribes it as volatile. If that node starts later,
it works with its first value until the next change.

For example, `/board` latches `/hardware/stop_state`. `/joystick` subscribes it with the default
QoS, starts later, and drives.

## What to do

Let the subscription ask for transient local too, with a depth of 1.

## When it is silent

For plans, missions and goals, where the QoS of an end is unknown, and where the publisher may send
the state again. Readers that only show the state are `pedantic`.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import wiring_groups
from rtron.vocabulary import (
    ActionRole,
    Certainty,
    Direction,
    Durability,
    Endpoint,
    Finding,
    FindingLevel,
    WiringFactKind,
    normalise_type,
)
from rtron.wording import conjugate, join_names

_STATES = frozenset(
    {
        *("stop", "estop", "stopped", "halt", "pause", "paused", "lock", "locked", "safety"),
        *("enable", "enabled", "disable", "disabled", "active", "armed", "ready", "mode", "state"),
        *("status", "map", "zone", "zones", "limit", "limits"),
    }
)
"""Words of the names of topics that tell others what they may do, or where."""
_MAP_SERVERS = ("map_server", "nav2_map_server::MapServer")
"""Nav2's server sends its map when it is activated, and when another map is loaded."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each latched state with readers that ask for no history."""
    groups = wiring_groups(app.graph, WiringFactKind.STATE_PUBLISHER)
    senders = {group.subject: group.values for group in groups}
    acting = _acting(app)
    for topic in app.explicit_topics if app.graph.ros != 1 else ():
        publishers = app.graph.publishers(topic)
        is_state = not _STATES.isdisjoint(topic.rpartition("/")[2].split("_"))
        if is_state and publishers:
            is_rare = (e.node in senders.get(topic, ()) or _is_map(app, e) for e in publishers)
            late = _late_readers(app, topic) if all(is_rare) else []
            yield from [_finding(app, topic, late, acting)] if late else []


def _is_map(app: AppFacts, end: Endpoint) -> bool:
    is_map = normalise_type(end.type) == "nav_msgs/OccupancyGrid"
    node = app.nodes.get(end.node)
    return is_map and node is not None and node.executable in _MAP_SERVERS


def _late_readers(app: AppFacts, topic: str) -> list[str]:
    """Return the nodes all of whose subscriptions of a topic ask for no history."""
    is_volatile: dict[str, list[bool]] = defaultdict(list)
    for end in app.graph.subscribers(topic):
        is_volatile[end.node].append(
            end.qos is not None and end.qos.durability is Durability.VOLATILE
        )
    others = set(app.readers(topic)).difference(app.publishers(topic))
    return sorted(node for node in others if all(is_volatile[node]))


def _acting(app: AppFacts) -> set[str]:
    """Return the nodes that send something, call something, or obey commands of motion."""
    sent = {end.node for end in app.graph.endpoints if _is_sent(end)}
    moved = (app.readers(topic) for topic in app.motion_topics if not app.is_stop(topic))
    clients = (each.node for each in app.graph.clients if not each.implicit)
    goals = (each.node for each in app.graph.actions if each.role is ActionRole.CLIENT)
    return sent.union(clients, goals, *moved)


def _is_sent(end: Endpoint) -> bool:
    return end.direction is Direction.PUBLISH and not end.implicit


def _finding(app: AppFacts, topic: str, readers: list[str], acting: set[str]) -> Finding:
    publishers = app.publishers(topic)
    endpoints = (*app.graph.publishers(topic), *app.graph.subscribers(topic))
    return make_finding(
        RULE.name,
        topic,
        summary=f"{join_names(readers)} {conjugate(readers, 'lose')} the state on {topic} if "
        f"{'they start' if readers[1:] else 'it starts'} later than it is sent",
        cause=f"{join_names(publishers)} {conjugate(publishers, 'latch')} it and "
        f"{conjugate(publishers, 'send')} it only when it changes; the subscription is volatile "
        "and gets nothing from before",
        remedy="let the subscription ask for transient local, with a depth of 1",
        consequence=app.consequence(topic, readers),
        certainty=Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if acting.isdisjoint(readers) else None,
        nodes=(*publishers, *readers),
        topics=(topic,),
        evidence=app.evidence(end for end in endpoints if end.node in (*publishers, *readers)),
    )


RULE = FindingRule(
    name="missed_state",
    title="A reader that starts later never learns a latched state",
    consequence="failure, or motion on a topic that commands it: likely",
    since="0.1.0",
    check=check,
)
