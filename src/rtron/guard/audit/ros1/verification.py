"""One audit of a ROS 1 app as a result: every planned path, and who is there beside it.

Pure: what the master and the nodes have answered comes in as `ApiAnswers`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.guard.audit.common.guard_inputs import GuardInput
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import (
    NodeAddresses,
    foreign_connections,
    normalise_uri,
    planned_sources,
)
from rtron.guard.audit.ros1.registrations import MasterRegistrations, foreign_publisher_alarms
from rtron.vocabulary import GUARD_NODE, Plan, TopicAccess, UnguardedPath, matches_node
from rtron.vocabulary.verification import GuardedPath, PathState, Verification, unguarded_paths
from rtron.wire.ros1.ros_api import BusConnection, NamedNode

_LOGGERS = ("/get_loggers", "/set_logger_level")
_PARAMETERS = "/set_parameters"


@dataclass(frozen=True, slots=True, kw_only=True)
class ApiAnswers:
    """What was answered: the master's list, addresses by node, connections and process ids.

    `connections` and `pids` lack a node that does not answer, `uris` one that the master does not
    know. `nodes` are all that the master lists, `guard_peers` are topics and whom the guard's nodes
    are connected to on them, as these call themselves: only the guard knows of them after a restart
    of the master. `guard_parents` are the parents' ids of the processes of the guard's nodes: all
    have been forked by one. It is 0 for a node that answers without one, as others' nodes do.
    """

    state: MasterRegistrations
    nodes: frozenset[str] = frozenset()
    guard_peers: frozenset[NamedNode] = frozenset()
    services: tuple[tuple[str, str], ...] = ()
    uris: Mapping[str, str] = field(default_factory=dict)
    connections: Mapping[str, frozenset[BusConnection]] = field(default_factory=dict)
    pids: Mapping[str, int] = field(default_factory=dict)
    guard_parents: Mapping[str, int] = field(default_factory=dict)


def verify(plan: Plan, answers: ApiAnswers) -> Verification:
    """Compare what runs with what the plan says."""
    expected = ExpectedGraph(plan)
    addresses = _addresses(expected, answers)
    return Verification(
        paths=(*_output_paths(expected, answers, addresses), *_input_paths(expected, answers)),
        problems=tuple(_problems(expected, answers)),
        unguarded=tuple(unguarded_paths(plan, _unguarded(expected, answers))),
    )


def queried_nodes(expected: ExpectedGraph, state: MasterRegistrations) -> frozenset[str]:
    """Return the nodes whose address has to be known: all on planned topics, and the guard's."""
    listed = (nodes for side in (state.publishers, state.subscribers) for nodes in side.values())
    return expected.guard_nodes.union(*listed)


def pinged_nodes(expected: ExpectedGraph, state: MasterRegistrations) -> frozenset[str]:
    """Return the nodes whose process has to answer: the guard's, and those that publish to it.

    The master goes on to list a node that was killed.
    """
    inputs = (state.publishers.get(each.private, frozenset()) for each in expected.inputs)
    return expected.guard_nodes.union(*inputs)


def _addresses(expected: ExpectedGraph, answers: ApiAnswers) -> NodeAddresses:
    guard_uris = {node: uri for node, uri in answers.uris.items() if node in expected.guard_nodes}
    addresses = NodeAddresses(guard_uris)
    for node, uri in answers.uris.items():
        addresses.learn(normalise_uri(uri), node)
    return addresses


def _output_paths(
    expected: ExpectedGraph, answers: ApiAnswers, addresses: NodeAddresses
) -> Iterator[GuardedPath]:
    for public, private in expected.outputs.items():
        topic = expected.topics[private]
        for pattern in topic.subscribers:
            if pattern in expected.guard_nodes:
                continue
            nodes = [
                n for n in _candidate_nodes(answers, public, private) if matches_node(pattern, n)
            ]
            if not nodes:
                yield from _unlisted_paths(answers, public, private, pattern)
            for node in nodes:
                yield _output_path(expected, answers, addresses, public, node)


def _candidate_nodes(answers: ApiAnswers, *topics: str) -> list[str]:
    """Return who listens to one of the topics, or could be asked."""
    listening = {n for topic in topics for n in answers.state.subscribers.get(topic, ())}
    return sorted(listening | answers.connections.keys())


def _output_path(
    expected: ExpectedGraph, answers: ApiAnswers, addresses: NodeAddresses, public: str, node: str
) -> GuardedPath:
    private = expected.outputs[public]
    topics = {name: expected.topics[name] for name in (public, private)}
    state, reason, foreign = _output_state(answers, addresses, topics, node)
    if state is PathState.CLOSED and node in answers.state.subscribers.get(public, ()):
        state, reason = PathState.DRIFT, f"listens to {public}: its remap is missing"
    elif state is PathState.CLOSED and not planned_sources(
        topics[private], answers.connections[node], addresses
    ):
        state, reason = PathState.DRIFT, f"is not connected to {private}"
    return GuardedPath(
        topic=public, private=private, node=node, state=state, reason=reason, foreign=foreign
    )


def _output_state(
    answers: ApiAnswers, addresses: NodeAddresses, topics: Mapping[str, TopicAccess], node: str
) -> tuple[PathState, str, tuple[str, ...]]:
    if node not in answers.connections:
        return PathState.UNKNOWN, "does not say who speaks to it", ()
    found = foreign_connections(node, answers.connections[node], topics, addresses)
    if not found:
        return PathState.CLOSED, "", ()
    names = tuple(
        sorted({addresses.node_of(each.connection) or each.connection.source for each in found})
    )
    return PathState.OPEN, f"hears {', '.join(names)} past the guard", names


def _unlisted_paths(
    answers: ApiAnswers, public: str, private: str, pattern: str
) -> Iterator[GuardedPath]:
    """Yield what is known of a node whose end of a stream the master does not list."""
    connected = {node for topic, node in answers.guard_peers if topic == private}
    if found := sorted(node for node in connected if matches_node(pattern, node)):
        reason = "is connected to the guard, but the master does not list it: restart the node"
    elif found := sorted(node for node in answers.nodes if matches_node(pattern, node)):
        reason = f"is listed by the master, but uses neither {public} nor {private}"
    else:
        yield GuardedPath(topic=public, private=private, node=pattern, state=PathState.NOT_SEEN)
        return
    for node in found:
        yield GuardedPath(
            topic=public, private=private, node=node, state=PathState.UNKNOWN, reason=reason
        )


def _input_paths(expected: ExpectedGraph, answers: ApiAnswers) -> Iterator[GuardedPath]:
    for guard_input in expected.inputs:
        for pattern in guard_input.publishers:
            yield from _input_path(expected, answers, guard_input, pattern)


def _input_path(
    expected: ExpectedGraph, answers: ApiAnswers, guard_input: GuardInput, pattern: str
) -> Iterator[GuardedPath]:
    publishers = answers.state.publishers
    outside = [
        n for n in sorted(publishers.get(guard_input.public, ())) if n not in expected.guard_nodes
    ]
    inside = [
        n for n in sorted(publishers.get(guard_input.private, ())) if n not in expected.guard_nodes
    ]
    found = {n: _publisher_state(answers, n) for n in inside if matches_node(pattern, n)}
    drift = (PathState.DRIFT, f"publishes {guard_input.public}: its remap is missing")
    found |= {n: drift for n in outside if matches_node(pattern, n)}
    public, private = guard_input.public, guard_input.private
    if not found:
        yield from _unlisted_paths(answers, public, private, pattern)
    for node, (state, reason) in found.items():
        yield GuardedPath(topic=public, private=private, node=node, state=state, reason=reason)


def _publisher_state(answers: ApiAnswers, node: str) -> tuple[PathState, str]:
    if node in answers.pids:
        return PathState.CLOSED, ""
    return PathState.UNKNOWN, "is listed by the master, but does not answer"


def _problems(expected: ExpectedGraph, answers: ApiAnswers) -> Iterator[str]:
    for node in sorted(expected.enforcing_nodes):
        if node not in answers.uris:
            yield f"the guard's node {node} is not running"
        elif node not in answers.pids:
            yield f"the guard's node {node} does not answer"
    yield from _impostors(expected, answers)
    yield from (alarm.reason for alarm in foreign_publisher_alarms(answers.state, expected))


def _impostors(expected: ExpectedGraph, answers: ApiAnswers) -> Iterator[str]:
    """Yield the nodes with a name of the guard's that another process has started, or may have."""
    parents = answers.guard_parents
    nodes = sorted(answers.pids.keys() & expected.guard_nodes)
    if nodes and not parents.get(GUARD_NODE):
        yield f"{GUARD_NODE} does not tell its parent: whose the guard's nodes are is not known"
        return
    for node in nodes:
        if node not in parents:
            yield f"{node} did not answer who its parent is: whether it is the guard's is not known"
        elif parents[node] != parents[GUARD_NODE]:
            yield f"{node} is no node of the guard: another process has taken its name"


def _unguarded(expected: ExpectedGraph, answers: ApiAnswers) -> Iterator[UnguardedPath]:
    for service, node in answers.services:
        if expected.audited_topics(node) and not service.endswith(_LOGGERS):
            is_parameter_service = service.endswith(_PARAMETERS)
            effect = "changes parameters of" if is_parameter_service else "is a service of"
            yield UnguardedPath(what=service, why=f"{effect} {node}, behind the guard")
