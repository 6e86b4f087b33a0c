"""Ghost publishers of ROS 1: connected to a subscriber, and not in the master's list."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.sources.live.ros1.replies import IncomingConnection, NamedNode
from rtron.sources.ros1_node import NodeReplies
from rtron.vocabulary import Evidence, UnresolvedItem


@dataclass(frozen=True, slots=True)
class UnlistedConnection:
    """A connection of a node's whose other end the master did not list."""

    node: str
    connection: IncomingConnection


def unlisted_connections(
    nodes: Mapping[str, NodeReplies], publishers: Iterable[NamedNode]
) -> tuple[UnlistedConnection, ...]:
    """Return the connections from addresses that no publisher of their topic has."""
    known_publishers = _listed_publishers(
        publishers, {name: replies.uri for name, replies in nodes.items()}
    )
    return tuple(
        UnlistedConnection(name, connection)
        for name, replies in nodes.items()
        for connection in dict.fromkeys(replies.incoming)
        if (connection.topic, _normalised_uri(connection.publisher_uri)) not in known_publishers
    )


def ghost_publishers(
    connections: Iterable[UnlistedConnection],
    publishers: Iterable[NamedNode],
    uris: Mapping[str, str],
) -> Iterator[UnresolvedItem]:
    """Yield an entry for each suspect that the master, asked again, does not list either."""
    known_publishers = _listed_publishers(publishers, uris)
    for unlisted in connections:
        if (
            unlisted.connection.topic,
            _normalised_uri(unlisted.connection.publisher_uri),
        ) not in known_publishers:
            yield _ghost_publisher(unlisted.node, unlisted.connection)


def _listed_publishers(
    publishers: Iterable[NamedNode], uris: Mapping[str, str]
) -> set[tuple[str, str]]:
    return {
        (topic, _normalised_uri(uris.get(node, ""))) for topic, node in publishers if uris.get(node)
    }


def _normalised_uri(uri: str) -> str:
    return uri.rstrip("/").lower()


def _ghost_publisher(node: str, connection: IncomingConnection) -> UnresolvedItem:
    source = connection.publisher_uri or "an unknown address"
    why = f"takes messages on {connection.topic} from {source}, which the master does not know"
    return UnresolvedItem(what=node, why=why, evidence=(Evidence(file=source),))
