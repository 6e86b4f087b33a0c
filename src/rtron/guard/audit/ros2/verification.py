"""One audit of a ROS 2 domain as a result: every planned path, and who is there beside it.

Pure. From outside nobody can prove which of two participants is the guard; it is taken to be the
one with most of the guard's endpoints, and that there are two is told.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.guard.audit.ros2.endpoint_checks import (
    Participants,
    display_name,
    endpoint_labels,
    foreign_publishers,
    foreign_sources,
    matching_nodes,
    publication_problem,
    subscription_problem,
    unplanned_subscribers,
)
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.unguarded_interfaces import unguarded_interfaces
from rtron.guard.supervision.guard_config import stopped_streams
from rtron.vocabulary import GUARD_NODE, SUPERVISOR_NODE, matches_node
from rtron.vocabulary.verification import GuardedPath, PathState, Verification

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.audit.common.guard_inputs import GuardInput
    from rtron.guard.audit.ros2.observed_graph import ObservedGraph
    from rtron.vocabulary import Plan, TopicAccess
    from rtron.wire.ros2.endpoints import Ros2Endpoint

_NO_NAME = "somebody listens whose node the domain does not name"

_PROCESSES = 2
"""The command process and the bulk process."""


@dataclass(frozen=True, slots=True)
class _Comparison:
    """What is compared: the plan and the domain, the guard's participants in it, and doubles.

    `has_supervisor_node` tells whether the supervisor stops anything: only then it has a node.
    """

    expected: ExpectedGraph
    observed: ObservedGraph
    guard_participants: Participants
    duplicates: dict[str, frozenset[bytes]]
    has_supervisor_node: bool


def verify_ros2(plan: Plan, observed: ObservedGraph) -> Verification:
    """Compare what is in a domain with what the plan says."""
    expected = ExpectedGraph(plan)
    has_supervisor_node = bool(stopped_streams(plan))
    comparison = _Comparison(
        expected,
        observed,
        find_guard_participants(expected, observed),
        find_duplicate_names(observed),
        has_supervisor_node,
    )
    return Verification(
        paths=tuple(_paths(comparison)),
        problems=tuple(_problems(comparison)),
        unguarded=tuple(unguarded_interfaces(plan, expected, observed)),
    )


def verify_ros2_cell(plan: Plan, inside: ObservedGraph) -> Verification:
    """Compare what is in a cell with what the plan says; only the paths are told.

    There is only the node and what RTron has started, so a name of the guard is the guard's.
    """
    expected = ExpectedGraph(plan)
    found = (inside.participants.get(name, ()) for name in expected.guard_nodes)
    guards = frozenset(each for participants in found for each in participants)
    comparison = _Comparison(expected, inside, guards, {}, has_supervisor_node=True)
    return Verification(paths=tuple(_paths(comparison)), problems=(), unguarded=())


def find_guard_participants(expected: ExpectedGraph, observed: ObservedGraph) -> Participants:
    """Return the participant with most endpoints of each process's nodes, and the supervisor's."""
    guard = {found for nodes in expected.lanes if (found := _main_participant(nodes, observed))}
    supervisors = observed.participants.get(SUPERVISOR_NODE, set())
    return frozenset(guard | (supervisors if len(supervisors) == 1 else set()))


def _main_participant(nodes: frozenset[str], observed: ObservedGraph) -> bytes | None:
    counts = Counter(each.participant for each in observed.endpoints if each.node in nodes)
    return max(counts, key=lambda each: (counts[each], each), default=None)


def find_duplicate_names(observed: ObservedGraph) -> dict[str, frozenset[bytes]]:
    """Return the node names that several participants have, and which."""
    found = observed.participants
    return {node: frozenset(each) for node, each in found.items() if len(each) > 1}


def _paths(comparison: _Comparison) -> Iterator[GuardedPath]:
    yield from _output_paths(comparison)
    yield from _input_paths(comparison)


def _output_paths(comparison: _Comparison) -> Iterator[GuardedPath]:
    for public, private in comparison.expected.outputs.items():
        for pattern in comparison.expected.topics[private].subscribers:
            if pattern not in comparison.expected.guard_nodes:
                yield from _output_path(comparison, public, private, pattern)


def _output_path(
    comparison: _Comparison, public: str, private: str, pattern: str
) -> Iterator[GuardedPath]:
    endpoints = [
        *comparison.observed.subscribers(private),
        *comparison.observed.subscribers(public),
    ]
    nodes = matching_nodes(comparison.expected, endpoints, (pattern,))
    for node in nodes:
        state, reason, foreign = _output_state(comparison, public, private, node)
        yield _guarded_path(public, private, node, state, reason, foreign)
    if nodes:
        return
    if any(not endpoint.node for endpoint in comparison.observed.subscribers(private)):
        yield _guarded_path(public, private, pattern, PathState.UNKNOWN, _NO_NAME)
    else:
        state, reason = _unseen_state(comparison, pattern, "listens to neither name")
        yield _guarded_path(public, private, pattern, state, reason)


def _output_state(
    comparison: _Comparison, public: str, private: str, node: str
) -> tuple[PathState, str, tuple[str, ...]]:
    expected, observed = comparison.expected, comparison.observed
    topics = (expected.topics[private], expected.topics[public])
    foreign = endpoint_labels(
        expected, foreign_sources(expected, observed, topics, node, comparison.guard_participants)
    )
    if foreign:
        return PathState.OPEN, f"hears {', '.join(foreign)} past the guard", foreign
    if any(endpoint.node == node for endpoint in observed.subscribers(public)):
        return PathState.DRIFT, f"listens to {display_name(public)}: its remap is missing", ()
    subscriptions = [
        endpoint for endpoint in observed.subscribers(private) if endpoint.node == node
    ]
    reasons = filter(
        None,
        (
            subscription_problem(
                expected, observed, topics[0], endpoint, comparison.guard_participants
            )
            for endpoint in subscriptions
        ),
    )
    if why := next(reasons, ""):
        return PathState.DRIFT, f"does not hear the guard: {why}", ()
    return PathState.CLOSED, _unplanned_note(comparison, private), ()


def _input_paths(comparison: _Comparison) -> Iterator[GuardedPath]:
    for guard_input in comparison.expected.inputs:
        topic = comparison.expected.topics[guard_input.private]
        foreign = endpoint_labels(
            comparison.expected,
            foreign_publishers(
                comparison.expected, comparison.observed, topic, comparison.guard_participants
            ),
        )
        for node in _input_nodes(comparison, guard_input):
            state, reason, found = _input_state(comparison, guard_input, node, foreign)
            yield _guarded_path(guard_input.public, guard_input.private, node, state, reason, found)


def _input_nodes(comparison: _Comparison, guard_input: GuardInput) -> tuple[str, ...]:
    endpoints = [
        *comparison.observed.publishers(guard_input.private),
        *comparison.observed.publishers(guard_input.public),
    ]
    return (
        matching_nodes(comparison.expected, endpoints, guard_input.publishers)
        or guard_input.publishers
    )


def _input_state(
    comparison: _Comparison, guard_input: GuardInput, node: str, foreign: tuple[str, ...]
) -> tuple[PathState, str, tuple[str, ...]]:
    publishers = [
        endpoint
        for endpoint in comparison.observed.publishers(guard_input.private)
        if endpoint.node == node
    ]
    if foreign:
        return PathState.OPEN, f"{', '.join(foreign)} speaks in its place", foreign
    if node in comparison.duplicates:
        participants = _hex_ids(comparison.duplicates[node])
        reason = f"{len(participants)} participants have its name: {', '.join(participants)}"
        return (
            PathState.OPEN,
            reason,
            tuple(f"{node} of the participant {each}" for each in participants),
        )
    if any(
        endpoint.node == node for endpoint in comparison.observed.publishers(guard_input.public)
    ):
        return (
            PathState.DRIFT,
            f"publishes {display_name(guard_input.public)}: its remap is missing",
            (),
        )
    if not publishers:
        return *_unseen_state(comparison, node, "speaks on neither name"), ()
    problem = next(
        filter(
            None,
            (_publication_problem(comparison, guard_input, endpoint) for endpoint in publishers),
        ),
        "",
    )
    if problem:
        return PathState.DRIFT, f"is not heard by the guard: {problem}", ()
    return PathState.CLOSED, _unplanned_note(comparison, guard_input.private), ()


def _publication_problem(
    comparison: _Comparison, guard_input: GuardInput, endpoint: Ros2Endpoint
) -> str:
    return publication_problem(
        comparison.expected, comparison.expected.topics[guard_input.private], endpoint
    )


def _unplanned_note(comparison: _Comparison, private: str) -> str:
    """Return who listens without being planned: that moves nothing, and is only told."""
    others = unplanned_subscribers(
        comparison.expected, comparison.observed, comparison.expected.topics[private]
    )
    return f"{', '.join(others)} listens, too" if others else ""


def _problems(comparison: _Comparison) -> Iterator[str]:
    for node in sorted(comparison.expected.enforcing_nodes - set(comparison.observed.nodes)):
        yield f"the guard's node {node} is not running"
    yield from _name_problems(comparison)
    input_topics = {guard_input.private for guard_input in comparison.expected.inputs}
    for topic in comparison.expected.private_topics():
        foreign = foreign_publishers(
            comparison.expected, comparison.observed, topic, comparison.guard_participants
        )
        is_reported = topic.topic in input_topics or bool(_planned_listeners(comparison, topic))
        for name in endpoint_labels(comparison.expected, foreign) if not is_reported else ():
            yield f"{name} speaks on the private {display_name(topic)}"


def _planned_listeners(comparison: _Comparison, topic: TopicAccess) -> tuple[str, ...]:
    """Return the successors that listen to an output: what they hear is told of their paths."""
    if topic.topic not in comparison.expected.outputs.values():
        return ()
    return matching_nodes(
        comparison.expected, comparison.observed.subscribers(topic.topic), topic.subscribers
    )


def _name_problems(comparison: _Comparison) -> Iterator[str]:
    """Yield the guard's names that somebody else has, too."""
    for node in sorted(comparison.expected.guard_nodes):
        participants = comparison.observed.participants.get(node, set())
        others = _hex_ids(participants - comparison.guard_participants)
        number = comparison.observed.nodes.count(node)
        if others:
            yield f"{', '.join(others)} has the name of the guard's node {node}"
        elif number > _max_nodes(comparison, node):
            yield f"{number} nodes have the name of the guard's node {node}"


def _max_nodes(comparison: _Comparison, node: str) -> int:
    """Return how many nodes may have a name: each process of the guard sees the graph as one."""
    supervised = SUPERVISOR_NODE in comparison.observed.nodes or not comparison.has_supervisor_node
    return (_PROCESSES + supervised) if node == GUARD_NODE else 1


def _hex_ids(participants: set[bytes] | frozenset[bytes]) -> tuple[str, ...]:
    return tuple(each.hex() for each in sorted(participants))


def _unseen_state(comparison: _Comparison, pattern: str, what: str) -> tuple[PathState, str]:
    """Return what is known of a node that has none of the endpoints that the plan gives it."""
    if any(matches_node(pattern, node) for node in comparison.observed.nodes):
        return PathState.UNKNOWN, f"it runs, and {what}"
    return PathState.NOT_SEEN, ""


def _guarded_path(
    public: str,
    private: str,
    node: str,
    state: PathState,
    reason: str = "",
    foreign: tuple[str, ...] = (),
) -> GuardedPath:
    return GuardedPath(
        topic=display_name(public),
        private=display_name(private),
        node=node,
        state=state,
        reason=reason,
        foreign=foreign,
    )
