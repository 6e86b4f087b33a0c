"""The InteractionGraph of the app that runs at a ROS 1 master (ROS wiki: Master and Slave API).

Asked with the standard library's XML-RPC and without joining the graph. Nodes are strangers:
whatever they answer, or do not, ends as an Unresolved entry and within the time allowed.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from rtron.errors import RTronError, SourceError
from rtron.sources.live.ros1.actions import find_actions
from rtron.sources.live.ros1.queries import (
    NodeReplies,
    query_node,
    query_service_type,
    run_with_deadline,
)
from rtron.vocabulary import (
    Direction,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    Resolution,
    Service,
    Topic,
    UnresolvedItem,
)
from rtron.wire.ros1.ros_api import (
    BusConnection,
    NamedNode,
    SystemState,
    parse_text,
    parse_topic_types,
    query_node_uri,
    query_system_state,
)
from rtron.wire.ros1.xmlrpc import ros_call


@dataclass(frozen=True, slots=True)
class UnlistedConnection:
    """A connection of a node's whose other end the master did not list."""

    node: str
    connection: BusConnection


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
        if (connection.topic, _normalised_uri(connection.source)) not in known_publishers
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
            _normalised_uri(unlisted.connection.source),
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


def _ghost_publisher(node: str, connection: BusConnection) -> UnresolvedItem:
    source = connection.source or "an unknown address"
    why = f"takes messages on {connection.topic} from {source}, which the master does not know"
    return UnresolvedItem(what=node, why=why, evidence=(Evidence(file=source),))


_CALLER_ID = "/rtron_scan"
_NODE_CALLS = 3
_SERVICE_CALLS = 2
_LOG_TOPICS = frozenset({"/rosout", "/rosout_agg"})
_CLOCK_TOPIC = "/clock"


@dataclass(frozen=True, slots=True)
class Ros1LiveSource:
    """A Source that asks a running master and its nodes.

    `timeout` (s) is for each call; the whole takes at most ten times as long.
    """

    master_uri: str
    timeout: float

    def read(self) -> InteractionGraph:
        """Return the graph of the app that is running; SourceError if its master cannot be read."""
        try:
            return self._graph()
        except RTronError as error:
            message = f"no app can be read at {self.master_uri}: {error}"
            help = "is it running (`roscore`)? name another with --master or ROS_MASTER_URI"
            raise SourceError(message, help=help) from error

    def _graph(self) -> InteractionGraph:
        state = self._state()
        types = parse_topic_types(self._call_master("getTopicTypes"))
        nodes = self._nodes(state)
        services = self._services(state, nodes)
        endpoints = tuple(_endpoints(state, types, nodes))
        ghosts = self._ghosts(state, nodes)
        return InteractionGraph(
            app="live app",
            nodes=tuple(_node(name, answers) for name, answers in nodes.items()),
            topics=_topics(endpoints),
            endpoints=endpoints,
            services=services,
            actions=find_actions(endpoints),
            unresolved=(
                *_malformed_entries(state),
                *_unanswered_nodes(nodes),
                *_services_without_type(services, nodes),
                *ghosts,
            ),
        )

    def _state(self) -> SystemState:
        return query_system_state(self.master_uri, _CALLER_ID, self.timeout)

    def _call_master(self, method: str, *params: str) -> Any:  # noqa: ANN401 - XML-RPC
        return ros_call(self.master_uri, method, _CALLER_ID, *params, timeout=self.timeout)

    def _nodes(self, state: SystemState) -> dict[str, NodeReplies]:
        limit = _NODE_CALLS * self.timeout
        replies = run_with_deadline(
            {name: partial(self._query_node, name) for name in state.nodes()}, limit
        )
        timed_out = NodeReplies(error=f"no answer within {limit:g} s")
        return {name: replies.get(name, timed_out) for name in state.nodes()}

    def _query_node(self, name: str) -> NodeReplies:
        uri = self._node_uri(name)
        if not uri:
            return NodeReplies(error="the master does not tell its address")
        return query_node(uri, _CALLER_ID, self.timeout)

    def _node_uri(self, name: str) -> str:
        try:
            return query_node_uri(self.master_uri, _CALLER_ID, name, self.timeout)
        except RTronError:
            return ""

    def _services(
        self, state: SystemState, nodes: Mapping[str, NodeReplies]
    ) -> tuple[Service, ...]:
        """Return the services; a node that does not answer is not asked for their types."""
        answering = (name for name, node in state.services if not nodes[node].error)
        jobs = {name: partial(self._service_type, name) for name in answering}
        types = run_with_deadline(jobs, _SERVICE_CALLS * self.timeout)
        return tuple(
            Service(node=node, name=name, type=types.get(name, "")) for name, node in state.services
        )

    def _service_type(self, name: str) -> str:
        try:
            uri = parse_text(self._call_master("lookupService", name))
            return query_service_type(uri, name, _CALLER_ID, self.timeout)
        except Exception:  # noqa: BLE001 - a stranger's answer must not end the scan
            return ""

    def _ghosts(
        self, state: SystemState, nodes: Mapping[str, NodeReplies]
    ) -> tuple[UnresolvedItem, ...]:
        """Return the ghost publishers; the master is asked again, for who joined meanwhile."""
        unlisted = unlisted_connections(nodes, state.publishers)
        if not unlisted:
            return ()
        topics = {suspect.connection.topic for suspect in unlisted}
        publishers = [pair for pair in self._state().publishers if pair[0] in topics]
        queries = {node: partial(self._node_uri, node) for _, node in publishers}
        uris = run_with_deadline(queries, self.timeout)
        return tuple(ghost_publishers(unlisted, publishers, uris))


def _endpoints(
    state: SystemState, types: Mapping[str, str], nodes: Mapping[str, NodeReplies]
) -> Iterator[Endpoint]:
    sides = ((state.publishers, Direction.PUBLISH), (state.subscribers, Direction.SUBSCRIBE))
    for pairs, direction in sides:
        for topic, node in pairs:
            uri = nodes[node].uri
            yield Endpoint(
                node=node,
                topic=topic,
                direction=direction,
                type=types.get(topic, ""),
                implicit=_is_implicit(topic, direction),
                resolution=Resolution.OBSERVED,
                evidence=(Evidence(file=uri),) if uri else (),
            )


def _is_implicit(topic: str, direction: Direction) -> bool:
    return topic in _LOG_TOPICS or (topic == _CLOCK_TOPIC and direction is Direction.SUBSCRIBE)


def _topics(endpoints: Iterable[Endpoint]) -> tuple[Topic, ...]:
    types = {endpoint.topic: endpoint.type for endpoint in endpoints}
    return tuple(
        Topic(name=name, types=(type,) if type else ()) for name, type in sorted(types.items())
    )


def _node(name: str, replies: NodeReplies) -> Node:
    program = replies.program
    return Node(name=name, package=program.package, executable=program.executable)


def _unanswered_nodes(nodes: Mapping[str, NodeReplies]) -> Iterator[UnresolvedItem]:
    for name, replies in nodes.items():
        if replies.error:
            evidence = (Evidence(file=replies.uri),) if replies.uri else ()
            yield UnresolvedItem(what=name, why=replies.error, evidence=evidence)


def _services_without_type(
    services: Iterable[Service], nodes: Mapping[str, NodeReplies]
) -> Iterator[UnresolvedItem]:
    for service in services:
        if not service.type and not nodes[service.node].error:
            yield UnresolvedItem(
                what=service.name, why="the type of this service could not be read"
            )


def _malformed_entries(state: SystemState) -> Iterator[UnresolvedItem]:
    if state.malformed:
        why = f"has {state.malformed} malformed entries, which are left out"
        yield UnresolvedItem(what="the master's system state", why=why)
