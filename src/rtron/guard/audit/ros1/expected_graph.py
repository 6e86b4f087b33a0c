"""What the plan says about who speaks to whom: pure, for the audit and for `rtron verify`."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.vocabulary import (
    GUARD_NODE,
    PRIVATE_ROOT,
    Mode,
    Plan,
    PlannedTopic,
    Stream,
    flow_topic,
    names_node,
    output_topic,
    part_topic,
    planned_topics,
    stage_nodes,
    streams,
)
from rtron.vocabulary.action import ANSWERED, ASKED, SERVER
from rtron.vocabulary.topic_access import ANYBODY


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrance:
    """A way into the guard: who speaks there, under which public name, and on which private topic.

    `publishers` are node names or patterns.
    """

    public: str
    private: str
    publishers: tuple[str, ...]


class Expectations:
    """Who may speak to each guarded node on each topic that an enforced stream has closed.

    `guarding` are the guard's nodes on these streams, `own` all of them. `outputs` are the private
    outputs by their public names.
    """

    def __init__(self, plan: Plan) -> None:
        self.topics = {topic.topic: topic for topic in planned_topics(plan)}
        enforced = [stream for stream in streams(plan) if stream.mode is Mode.ENFORCE]
        self.entrances = tuple(way for stream in enforced for way in _entrances(stream))
        self.guarding = frozenset(
            {GUARD_NODE, *(n for each in enforced for n in stage_nodes(each))}
        )
        self.own = self.guarding.union(*map(stage_nodes, streams(plan)))
        self.outputs = {
            public: private
            for public in self.topics
            if (private := output_topic(public)) in self.topics
        }
        self._heard: dict[str, dict[str, PlannedTopic]] = {}

    def heard(self, node: str) -> dict[str, PlannedTopic]:
        """Return the topics on which it matters who speaks to a node; none for the guard's own.

        A node that listens to a private output must not hear strangers on the public name either.
        """
        if node not in self._heard:
            self._heard[node] = {} if node in self.own else dict(self._topics_of(node))
        return self._heard[node]

    def listeners(self) -> Iterator[str]:
        """Yield the nodes, by name or pattern, that listen to a private topic of the guard."""
        listed = {name for topic in self.private() for name in topic.subscribers}
        yield from sorted(listed - self.own)

    def private(self) -> Iterator[PlannedTopic]:
        """Yield the topics that only the guard and those whom it stands between know."""
        return (t for t in self.topics.values() if t.topic.startswith(PRIVATE_ROOT + "/"))

    def _topics_of(self, node: str) -> Iterator[tuple[str, PlannedTopic]]:
        for topic in self.private():
            if topic.may_subscribe(node):
                yield topic.topic, topic
        for public, private in self.outputs.items():
            if self.topics[private].may_subscribe(node):
                yield public, self.topics[public]


def is_open(topic: PlannedTopic) -> bool:
    """Tell whether the plan lets anybody speak on a topic."""
    return ANYBODY in topic.publishers


def _entrances(stream: Stream) -> Iterator[Entrance]:
    parts = [part_topic(stream.action, part) for part in ASKED] if stream.action else [stream.topic]
    for public in parts:
        for flow in stream.flows:
            private = flow_topic(public, flow.name)
            yield Entrance(public=public, private=private, publishers=(flow.publisher,))
    for part in ANSWERED if stream.action else ():
        public = part_topic(stream.action, part)
        private = flow_topic(public, SERVER)
        yield Entrance(public=public, private=private, publishers=stream.successors)


def meant(patterns: tuple[str, ...], node: str) -> bool:
    """Tell whether one of a plan's names or patterns means a node."""
    return any(names_node(pattern, node) for pattern in patterns)
