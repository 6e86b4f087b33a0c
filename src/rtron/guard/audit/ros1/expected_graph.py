"""What the plan says about who speaks to whom: pure, for the audit and for `rtron verify`."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice

from rtron.guard.audit.common.guard_inputs import GuardInput, matches_any
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    Mode,
    Plan,
    Stream,
    TopicAccess,
    build_streams,
    flow_topic,
    list_topic_access,
    output_topic,
    ros1_topic_name,
    stage_nodes,
)
from rtron.vocabulary.action import ROS1_CLIENT_TOPICS, ROS1_SERVER_TOPICS, SERVER_FLOW

MAX_MATCHING = 64
"""How many subscribers of a topic count that only match a pattern of the plan."""
_MAX_KNOWN_NODES = 1024
"""How many nodes' topics are remembered: strangers may have any number of names."""


class ExpectedGraph:
    """Who may speak to each guarded node on each topic that an enforced stream has closed.

    `enforcing_nodes` are the guard's nodes on these streams, `guard_nodes` all of its nodes.
    `outputs` are the private outputs by their public names.
    """

    def __init__(self, plan: Plan) -> None:
        self.topics = {topic.topic: topic for topic in list_topic_access(plan)}
        enforced = [stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE]
        self.inputs = tuple(way for stream in enforced for way in _inputs(stream))
        self.enforcing_nodes = frozenset(
            {GUARD_NODE, BULK_NODE, *(n for each in enforced for n in stage_nodes(each))}
        )
        self.guard_nodes = self.enforcing_nodes.union(*map(stage_nodes, build_streams(plan)))
        self.outputs = {
            public: private
            for public in self.topics
            if (private := output_topic(public)) in self.topics
        }
        self._topics_by_node: dict[str, dict[str, TopicAccess]] = {}

    def audited_topics(self, node: str) -> dict[str, TopicAccess]:
        """Return the topics on which it matters who speaks to a node; none for the guard's own.

        A node that listens to a private output must not hear strangers on the public name either.
        """
        if node not in self._topics_by_node:
            if len(self._topics_by_node) >= _MAX_KNOWN_NODES:
                self._topics_by_node.clear()
            self._topics_by_node[node] = (
                {} if node in self.guard_nodes else dict(self._topics_of(node))
            )
        return self._topics_by_node[node]

    def listener_patterns(self) -> Iterator[str]:
        """Yield the nodes, by name or pattern, that listen to a private topic of the guard."""
        listed = {name for topic in self.private_topics() for name in topic.subscribers}
        yield from sorted(listed - self.guard_nodes)

    def private_topics(self) -> Iterator[TopicAccess]:
        """Yield the topics that only the guard and those whom it stands between know."""
        return (t for t in self.topics.values() if t.topic.startswith(PRIVATE_ROOT + "/"))

    def _topics_of(self, node: str) -> Iterator[tuple[str, TopicAccess]]:
        for topic in self.private_topics():
            if topic.may_subscribe(node):
                yield topic.topic, topic
        for public, private in self.outputs.items():
            if self.topics[private].may_subscribe(node):
                yield public, self.topics[public]


def _inputs(stream: Stream) -> Iterator[GuardInput]:
    parts = (
        [ros1_topic_name(stream.action, part) for part in ROS1_CLIENT_TOPICS]
        if stream.action
        else [stream.topic]
    )
    for public in parts:
        for flow in stream.flows:
            private = flow_topic(public, flow.name)
            yield GuardInput(public=public, private=private, publishers=(flow.publisher,))
    for part in ROS1_SERVER_TOPICS if stream.action else ():
        public = ros1_topic_name(stream.action, part)
        private = flow_topic(public, SERVER_FLOW)
        yield GuardInput(public=public, private=private, publishers=stream.successors)


class PlannedListeners:
    """Selects the subscribers that the audit asks for: those that the plan expects.

    Whom the plan names always counts. Patterns match any number of names, so of these the first
    ones count.
    """

    def __init__(self, expected: ExpectedGraph) -> None:
        listed = list(expected.listener_patterns())
        self._guard_nodes = expected.guard_nodes
        self._names = frozenset(each for each in listed if "*" not in each)
        self._patterns = tuple(each for each in listed if "*" in each)

    def includes(self, node: str) -> bool:
        """Tell whether the plan expects a node to listen to the guard."""
        return node in self._names or self._matches(node)

    def select(self, subscribers: Mapping[str, Iterable[str]]) -> dict[str, frozenset[str]]:
        """Return the subscribers of each topic that the plan expects, given the oldest first."""
        found = {topic: self._select(nodes) for topic, nodes in subscribers.items()}
        return {topic: nodes for topic, nodes in found.items() if nodes}

    def _select(self, nodes: Iterable[str]) -> frozenset[str]:
        nodes = list(nodes)
        matching = filter(self._matches, nodes) if self._patterns else ()
        return self._names.intersection(nodes).union(islice(matching, MAX_MATCHING))

    def _matches(self, node: str) -> bool:
        return matches_any(self._patterns, node) and node not in self._guard_nodes
