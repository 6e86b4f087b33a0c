"""Which connections of a guarded node the plan does not name, and what to call them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from rtron.guard.audit.common.guard_inputs import allows_anybody
from rtron.guard.core.printable import printable
from rtron.vocabulary import Alarm, AlarmKind, TopicAccess
from rtron.wire.ros1.ros_api import BusConnection, parse_bus_info

_MAX_PUBLISHERS = 1024


def normalise_uri(uri: str) -> str:
    """Return a URI as it is compared: a slash at the end does not count."""
    return uri.rstrip("/")


def parse_connections(reply: object) -> frozenset[BusConnection]:
    """Read the answer of getBusInfo, with URIs as they are compared; WireError if it is none."""
    return frozenset(
        replace(each, source=normalise_uri(each.source)) for each in parse_bus_info(reply)
    )


class NodeAddresses:
    """The URIs of the guard's nodes and of planned publishers, compared as `normalise_uri` gives.

    `ports` are the guard's TCPROS ports: nobody else's messages can come from there. None if they
    are not known.
    """

    def __init__(self, guard_uris: Mapping[str, str], ports: frozenset[int] = frozenset()) -> None:
        self.guard_addresses = {normalise_uri(uri): node for node, uri in guard_uris.items()}
        self.ports = ports
        self._publishers: dict[str, str] = {}
        self._former_publishers: dict[str, str] = {}
        self.former_guard_uris: frozenset[str] = frozenset()

    def node_of(self, connection: BusConnection) -> str:
        """Return whose connection it is, empty if nobody's who is known.

        A connection to our address that leads to another port is not ours: somebody took the
        address over.
        """
        node = self.guard_addresses.get(connection.source)
        if node is None:
            return self._publishers.get(connection.source, "")
        return node if connection.port in (None, 0, *self.ports) or not self.ports else ""

    def learn(self, uri: str, node: str) -> None:
        """Take a planned publisher's address from the master; a name of our own is not learned."""
        if node in self.guard_addresses.values() or len(self._publishers) >= _MAX_PUBLISHERS:
            return
        for former in [known for known, name in self._publishers.items() if name == node]:
            self._former_publishers[former] = self._publishers.pop(former)
        self._former_publishers.pop(uri, None)
        self._publishers[uri] = node

    def address_of(self, node: str) -> str:
        """Return the address that was learned for a planned publisher, empty if none."""
        return next((uri for uri, name in self._publishers.items() if name == node), "")

    def publishers_of(self, topic: TopicAccess) -> frozenset[str]:
        """Return the addresses that were learned for the planned publishers of a topic."""
        return frozenset(uri for uri, name in self._publishers.items() if topic.may_publish(name))

    def is_former(self, uri: str) -> bool:
        """Tell whether a planned publisher, or a guard that has ended, had this address before."""
        return uri in self._former_publishers or uri in self.former_guard_uris


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
