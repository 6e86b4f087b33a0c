"""Which connections of a guarded node the plan does not name, and what to call them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from rtron.guard.audit.ros1.bus_info import BusConnection
from rtron.guard.audit.ros1.expected_graph import allows_anybody
from rtron.guard.audit.ros1.node_addresses import NodeAddresses
from rtron.guard.core.printable import printable
from rtron.vocabulary import Alarm, AlarmKind, TopicAccess


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignConnection:
    """A connection through which a guarded node hears somebody whom the plan does not name there.

    `stream_topic` is the public name of the stream that it goes past.
    """

    node: str
    connection: BusConnection
    guarded: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PeerIdentity:
    """What could be found out about a stranger.

    `name`: whom the master lists at the address. `is_refused`: nothing listens there any more.
    `is_answered`: the master has said what it knows.
    """

    name: str = ""
    is_refused: bool = False
    is_answered: bool = False


def foreign_connections(
    node: str,
    connections: Iterable[BusConnection],
    topics: Mapping[str, TopicAccess],
    addresses: NodeAddresses,
) -> frozenset[ForeignConnection]:
    """Return the connections of a node that should not be.

    Their ports are left out: rospy shows a connection before it stands and has a port.
    """
    return frozenset(
        ForeignConnection(
            node=node, connection=replace(link, port=None), guarded=topics[link.topic].stream_topic
        )
        for link in connections
        if link.topic in topics and not _is_planned(link, topics[link.topic], addresses)
    )


def planned_sources(
    topic: TopicAccess, connections: Iterable[BusConnection], addresses: NodeAddresses
) -> frozenset[str]:
    """Return the addresses from which a node rightly hears a topic."""
    return frozenset(
        link.source
        for link in connections
        if link.topic == topic.topic and _is_planned(link, topic, addresses)
    )


def foreign_connection_alarm(
    foreign: ForeignConnection, identity: PeerIdentity, guard_nodes: frozenset[str]
) -> Alarm:
    """Return what to tell about a stranger; what strangers call themselves is cut short."""
    peer = printable(identity.name or foreign.connection.source)
    kind, who = _kind_and_label(foreign, identity, guard_nodes)
    reason = f"{foreign.node} hears {foreign.connection.topic} from {who}, past the guard"
    return Alarm(
        kind=kind, reason=reason, topic=foreign.connection.topic, node=foreign.node, peer=peer
    )


def _kind_and_label(
    foreign: ForeignConnection, identity: PeerIdentity, guard_nodes: frozenset[str]
) -> tuple[AlarmKind, str]:
    source, name = printable(foreign.connection.source), printable(identity.name)
    if identity.name in guard_nodes:
        return AlarmKind.IMPOSTOR, f"{source}, which has taken the name {name}"
    if identity.name:
        return AlarmKind.FOREIGN_PUBLISHER, f"{name} at {source}"
    return (
        AlarmKind.UNREGISTERED_PUBLISHER,
        f"{source or 'nowhere'}, where the master lists no publisher of it",
    )


def _is_planned(connection: BusConnection, topic: TopicAccess, addresses: NodeAddresses) -> bool:
    if allows_anybody(topic):
        return True
    node = addresses.node_of(connection)
    return bool(node) and topic.may_publish(node)
