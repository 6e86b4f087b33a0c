"""Who may publish and hear what in the guarded app: the topics of a plan's enforced streams."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from rtron.vocabulary.action import (
    ANSWERED,
    ASKED,
    REQUESTED,
    SERVER,
    TOLD,
    ActionPart,
    end_name,
    part_topic,
)
from rtron.vocabulary.enums import Mode, StreamKind
from rtron.vocabulary.names import (
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    flow_topic,
    names_node,
    output_topic,
)
from rtron.vocabulary.plan import Plan
from rtron.vocabulary.stream import Stream
from rtron.vocabulary.streams import streams

ANYBODY = "*"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedTopic:
    """A topic, and the nodes that may publish and subscribe it: names, or patterns with `*`.

    `guarded` is the public name of the stream that it belongs to.
    """

    topic: str
    guarded: str
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]

    def may_publish(self, node: str) -> bool:
        """Tell whether the plan lets a node publish the topic."""
        return any(names_node(name, node) for name in self.publishers)

    def may_subscribe(self, node: str) -> bool:
        """Tell whether the plan lets a node listen."""
        return any(names_node(name, node) for name in self.subscribers)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedService:
    """A service of a guarded action of ROS 2, and the nodes that may offer and ask for it."""

    service: str
    guarded: str
    servers: tuple[str, ...]
    clients: tuple[str, ...]


def planned_topics(plan: Plan) -> tuple[PlannedTopic, ...]:
    """Return every topic that an enforced stream of a plan uses, each once."""
    enforced = (stream for stream in streams(plan) if stream.mode is Mode.ENFORCE)
    return tuple(topic for stream in enforced for topic in _topics(stream))


def planned_services(plan: Plan) -> tuple[PlannedService, ...]:
    """Return every service that an enforced stream of a plan uses, each once."""
    enforced = (stream for stream in streams(plan) if stream.mode is Mode.ENFORCE)
    requested = (stream for stream in enforced if stream.by_request)
    return tuple(service for stream in requested for service in _services(stream))


def stage_nodes(stream: Stream) -> tuple[str, ...]:
    """Return the names of a stream's coordination nodes, in order."""
    return tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)


def _topics(stream: Stream) -> Iterator[PlannedTopic]:
    nodes = stage_nodes(stream)
    if stream.by_request:
        yield from _told(stream, nodes[0])
        return
    yield from _entries(stream, stream.topic, nodes[-1])
    yield from _exits(stream, stream.topic, nodes[-1], stream.successors)
    for before, after in pairwise(nodes):
        joint = f"{PRIVATE_ROOT}{stream.topic}{before.removeprefix(PRIVATE_ROOT)}"
        yield _planned(stream, joint, (before,), (after,))
    if stream.action:
        yield from _action(stream, nodes[0])


def _action(stream: Stream, node: str) -> Iterator[PlannedTopic]:
    """Yield the four topics of an action beside its goals; one node is the server to clients."""
    cancel = part_topic(stream.action, ActionPart.CANCEL)
    yield from _entries(stream, cancel, node)
    yield from _exits(stream, cancel, node, stream.successors)
    clients = tuple(flow.publisher for flow in stream.flows)
    for part in ANSWERED:
        topic = part_topic(stream.action, part)
        yield _planned(stream, flow_topic(topic, SERVER), stream.successors, (node,))
        yield from _exits(stream, topic, node, clients)


def _told(stream: Stream, node: str) -> Iterator[PlannedTopic]:
    """Yield the topics of an action of ROS 2, which its server and the guard publish."""
    for action, publisher, listener in _sides(stream, node):
        for end in TOLD:
            yield _planned(stream, end_name(action, end), publisher, listener)


def _services(stream: Stream) -> Iterator[PlannedService]:
    """Yield the services of an action of ROS 2; who may ask under the public name, the guard says.

    Anybody may ask there, as anybody may publish a public topic in vain.
    """
    for action, servers, clients in _sides(stream, stage_nodes(stream)[0]):
        for end in REQUESTED:
            name = end_name(action, end)
            yield PlannedService(
                service=name, guarded=stream.topic, servers=servers, clients=clients
            )


def _sides(stream: Stream, node: str) -> Iterator[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    """Yield the names that an action of ROS 2 has, each with its servers and its clients."""
    yield output_topic(stream.action), stream.successors, (node,)
    for flow in stream.flows:
        yield flow_topic(stream.action, flow.name), (node,), (flow.publisher,)
    yield stream.action, (node,), (ANYBODY,)


def _entries(stream: Stream, topic: str, speaker: str) -> Iterator[PlannedTopic]:
    """Yield the private topics of the flows; on that of a successor the guard speaks too."""
    listener = stage_nodes(stream)[0]
    for flow in stream.flows:
        follows = any(names_node(flow.publisher, node) for node in stream.successors)
        publishers = (flow.publisher, speaker) if follows else (flow.publisher,)
        subscribers = (listener, flow.publisher) if follows else (listener,)
        yield _planned(stream, flow_topic(topic, flow.name), publishers, subscribers)


def _exits(
    stream: Stream, topic: str, node: str, listeners: tuple[str, ...]
) -> Iterator[PlannedTopic]:
    """Yield the private output and the public name; strangers speak there where they may."""
    asked = topic.rpartition("/")[2] in ASKED if stream.action else True
    strangers = (ANYBODY,) if asked and not stream.block_unapproved else ()
    moves = stream.stages[0].settings.kind is StreamKind.COMMAND and not stream.action
    supervisor = (SUPERVISOR_NODE,) if moves else ()
    yield _planned(stream, output_topic(topic), (node, *supervisor), listeners)
    yield _planned(stream, topic, (node, *strangers), (ANYBODY,))


def _planned(
    stream: Stream, topic: str, publishers: tuple[str, ...], subscribers: tuple[str, ...]
) -> PlannedTopic:
    return PlannedTopic(
        topic=topic, guarded=stream.topic, publishers=publishers, subscribers=subscribers
    )
