"""The InteractionGraph of the app that runs at a ROS 1 master (ROS wiki: Master and Slave API).

Asked with the standard library's XML-RPC and without joining the graph. Nodes are strangers:
whatever they answer, or do not, ends as an Unresolved entry and within the time allowed.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from rtron.errors import RTronError, SourceError
from rtron.sources.in_time import in_time
from rtron.sources.live.ros1.actions import actions_among
from rtron.sources.live.ros1.queries import service_type
from rtron.sources.live.ros1.replies import SystemState, system_state, text, topic_types
from rtron.sources.ros1_ghosts import still_unlisted, suspects
from rtron.sources.ros1_node import NodeAnswers, ask_node
from rtron.vocabulary import (
    Direction,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    Resolution,
    Service,
    Topic,
    Unresolved,
)
from rtron.wire.ros1.xmlrpc import ros_call

_CALLER = "/rtron_scan"
_NODE_CALLS = 3
_SERVICE_CALLS = 2
_LOGS = frozenset({"/rosout", "/rosout_agg"})
_CLOCK = "/clock"


@dataclass(frozen=True, slots=True)
class Ros1Live:
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
        types = topic_types(self._master("getTopicTypes"))
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
            actions=actions_among(endpoints),
            unresolved=(*_malformed(state), *_silent(nodes), *_untyped(services, nodes), *ghosts),
        )

    def _state(self) -> SystemState:
        return system_state(self._master("getSystemState"))

    def _master(self, method: str, *params: str) -> Any:  # noqa: ANN401 - XML-RPC
        return ros_call(self.master_uri, method, _CALLER, *params, timeout=self.timeout)

    def _nodes(self, state: SystemState) -> dict[str, NodeAnswers]:
        limit = _NODE_CALLS * self.timeout
        answers = in_time({name: partial(self._ask, name) for name in state.nodes()}, limit)
        late = NodeAnswers(fault=f"no answer within {limit:g} s")
        return {name: answers.get(name, late) for name in state.nodes()}

    def _ask(self, name: str) -> NodeAnswers:
        uri = self._uri_of(name)
        if not uri:
            return NodeAnswers(fault="the master does not tell its address")
        return ask_node(uri, _CALLER, self.timeout)

    def _uri_of(self, name: str) -> str:
        try:
            return text(self._master("lookupNode", name))
        except RTronError:
            return ""

    def _services(
        self, state: SystemState, nodes: Mapping[str, NodeAnswers]
    ) -> tuple[Service, ...]:
        """Return the services; a node that does not answer is not asked for their types."""
        answering = (name for name, node in state.services if not nodes[node].fault)
        jobs = {name: partial(self._service_type, name) for name in answering}
        types = in_time(jobs, _SERVICE_CALLS * self.timeout)
        return tuple(
            Service(node=node, name=name, type=types.get(name, "")) for name, node in state.services
        )

    def _service_type(self, name: str) -> str:
        try:
            uri = text(self._master("lookupService", name))
            return service_type(uri, name, _CALLER, self.timeout)
        except Exception:  # noqa: BLE001 - a stranger's answer must not end the scan
            return ""

    def _ghosts(
        self, state: SystemState, nodes: Mapping[str, NodeAnswers]
    ) -> tuple[Unresolved, ...]:
        """Return the ghost publishers; the master is asked again, for who joined meanwhile."""
        found = suspects(nodes, state.publishers)
        if not found:
            return ()
        topics = {suspect.link.topic for suspect in found}
        publishers = [pair for pair in self._state().publishers if pair[0] in topics]
        asked = {node: partial(self._uri_of, node) for _, node in publishers}
        uris = in_time(asked, self.timeout)
        return tuple(still_unlisted(found, publishers, uris))


def _endpoints(
    state: SystemState, types: Mapping[str, str], nodes: Mapping[str, NodeAnswers]
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
    return topic in _LOGS or (topic == _CLOCK and direction is Direction.SUBSCRIBE)


def _topics(endpoints: Iterable[Endpoint]) -> tuple[Topic, ...]:
    types = {endpoint.topic: endpoint.type for endpoint in endpoints}
    return tuple(
        Topic(name=name, types=(type,) if type else ()) for name, type in sorted(types.items())
    )


def _node(name: str, answers: NodeAnswers) -> Node:
    program = answers.program
    return Node(name=name, package=program.package, executable=program.executable)


def _silent(nodes: Mapping[str, NodeAnswers]) -> Iterator[Unresolved]:
    for name, answers in nodes.items():
        if answers.fault:
            evidence = (Evidence(file=answers.uri),) if answers.uri else ()
            yield Unresolved(what=name, why=answers.fault, evidence=evidence)


def _untyped(services: Iterable[Service], nodes: Mapping[str, NodeAnswers]) -> Iterator[Unresolved]:
    for service in services:
        if not service.type and not nodes[service.node].fault:
            yield Unresolved(what=service.name, why="the type of this service could not be read")


def _malformed(state: SystemState) -> Iterator[Unresolved]:
    if state.malformed:
        why = f"has {state.malformed} malformed entries, which are left out"
        yield Unresolved(what="the master's system state", why=why)
