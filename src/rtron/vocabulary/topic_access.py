"""Who may publish and hear what in the guarded app: the topics of a plan's enforced streams."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from rtron.vocabulary.action import (
    ROS1_CLIENT_TOPICS,
    ROS1_SERVER_TOPICS,
    ROS2_ACTION_SERVICES,
    ROS2_ACTION_TOPICS,
    SERVER_FLOW,
    Ros1ActionTopic,
    ros1_topic_name,
    ros2_entity_name,
)
from rtron.vocabulary.enums import Mode
from rtron.vocabulary.names import (
    GUARD_NODE,
    PRIVATE_ROOT,
    STOPPER_NODE,
    SUPERVISOR_NODE,
    flow_topic,
    lease_topic,
    matches_node,
    output_topic,
)
from rtron.vocabulary.plan import Plan
from rtron.vocabulary.streams import Stream, build_streams

ANY_NODE = "*"


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicAccess:
    """A topic, and the nodes that may publish and subscribe it: names, or patterns with `*`.

    `stream_topic` is the public name of the stream that it belongs to.
    """

    topic: str
    stream_topic: str
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]

    def may_publish(self, node: str) -> bool:
        """Tell whether the plan lets a node publish the topic."""
        return any(matches_node(name, node) for name in self.publishers)

    def may_subscribe(self, node: str) -> bool:
        """Tell whether the plan lets a node listen."""
        return any(matches_node(name, node) for name in self.subscribers)


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceAccess:
    """A service of a guarded action of ROS 2, and the nodes that may offer and ask for it."""

    service: str
    stream_topic: str
    servers: tuple[str, ...]
    clients: tuple[str, ...]


def list_topic_access(plan: Plan) -> tuple[TopicAccess, ...]:
    """Return every topic that an enforced stream of a plan uses, each once."""
    enforced = (stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE)
    topics = (topic for stream in enforced for topic in _topic_access(stream))
    return (*(_with_stopper(topic, plan.cell) for topic in topics), *_lease_requests(plan))


def _lease_requests(plan: Plan) -> Iterator[TopicAccess]:
    """Yield the topics on which commanders ask for leases; each belongs to the first stream."""
    for lease in plan.leases:
        grcns = [grcn for grcn in plan.grcn if grcn.lease == lease.name]
        if grcns and grcns[0].mode is Mode.ENFORCE:
            commanders = dict.fromkeys(flow.publisher for grcn in grcns for flow in grcn.flows)
            yield TopicAccess(
                topic=lease_topic(lease.name, "request"),
                stream_topic=grcns[0].topic,
                publishers=tuple(commanders),
                subscribers=(GUARD_NODE,),
            )


def _with_stopper(topic: TopicAccess, cell: tuple[str, ...]) -> TopicAccess:
    """Let the stopper of a cell publish beside the supervisor, on private topics alone."""
    is_private = topic.topic.startswith(f"{PRIVATE_ROOT}/")
    is_stopped = SUPERVISOR_NODE in topic.publishers and any(map(topic.may_subscribe, cell))
    if not (is_private and is_stopped):
        return topic
    return replace(topic, publishers=(*topic.publishers, STOPPER_NODE))


def list_service_access(plan: Plan) -> tuple[ServiceAccess, ...]:
    """Return every service that an enforced stream of a plan uses, each once."""
    enforced = (stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE)
    ros2_actions = (stream for stream in enforced if stream.is_ros2_action)
    return tuple(service for stream in ros2_actions for service in _ros2_action_services(stream))


def stage_nodes(stream: Stream) -> tuple[str, ...]:
    """Return the names of a stream's coordination nodes, in order."""
    return tuple(f"{PRIVATE_ROOT}/{stage.id}" for stage in stream.stages)


def _topic_access(stream: Stream) -> Iterator[TopicAccess]:
    nodes = stage_nodes(stream)
    if stream.is_ros2_action:
        yield from _ros2_action_topics(stream, nodes[0])
        return
    yield from _input_topics(stream, stream.topic, nodes[-1])
    yield from _output_topics(stream, stream.topic, nodes[-1], stream.successors)
    for before, after in pairwise(nodes):
        stage_topic = f"{PRIVATE_ROOT}{stream.topic}{before.removeprefix(PRIVATE_ROOT)}"
        yield _access(stream, stage_topic, (before,), (after,))
    if stream.action:
        yield from _ros1_action_topics(stream, nodes[0])


def _ros1_action_topics(stream: Stream, node: str) -> Iterator[TopicAccess]:
    """Yield the four topics of an action beside its goals; one node is the server to clients."""
    cancel = ros1_topic_name(stream.action, Ros1ActionTopic.CANCEL)
    yield from _input_topics(stream, cancel, node)
    yield from _output_topics(stream, cancel, node, stream.successors)
    clients = tuple(flow.publisher for flow in stream.flows)
    for part in ROS1_SERVER_TOPICS:
        topic = ros1_topic_name(stream.action, part)
        yield _access(stream, flow_topic(topic, SERVER_FLOW), stream.successors, (node,))
        yield from _output_topics(stream, topic, node, clients)


def _ros2_action_topics(stream: Stream, node: str) -> Iterator[TopicAccess]:
    """Yield the topics of an action of ROS 2, which its server and the guard publish."""
    for action, publisher, subscriber in _ros2_action_names(stream, node):
        for entity in ROS2_ACTION_TOPICS:
            yield _access(stream, ros2_entity_name(action, entity), publisher, subscriber)


def _ros2_action_services(stream: Stream) -> Iterator[ServiceAccess]:
    """Yield the services of an action of ROS 2; who may ask under the public name, the guard says.

    Anybody may ask there, as anybody may publish a public topic in vain.
    """
    for action, servers, clients in _ros2_action_names(stream, stage_nodes(stream)[0]):
        for entity in ROS2_ACTION_SERVICES:
            name = ros2_entity_name(action, entity)
            yield ServiceAccess(
                service=name, stream_topic=stream.topic, servers=servers, clients=clients
            )


def _ros2_action_names(
    stream: Stream, node: str
) -> Iterator[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    """Yield the names that an action of ROS 2 has, each with its servers and its clients."""
    yield output_topic(stream.action), stream.successors, (node,)
    for flow in stream.flows:
        yield flow_topic(stream.action, flow.name), (node,), (flow.publisher,)
    yield stream.action, (node,), (ANY_NODE,)


def _input_topics(stream: Stream, topic: str, guard_node: str) -> Iterator[TopicAccess]:
    """Yield the private topics of the flows; on that of a successor the guard speaks too."""
    first_node = stage_nodes(stream)[0]
    for flow in stream.flows:
        is_successor = any(matches_node(flow.publisher, node) for node in stream.successors)
        publishers = (flow.publisher, guard_node) if is_successor else (flow.publisher,)
        subscribers = (first_node, flow.publisher) if is_successor else (first_node,)
        yield _access(stream, flow_topic(topic, flow.name), publishers, subscribers)


def _output_topics(
    stream: Stream, topic: str, node: str, subscribers: tuple[str, ...]
) -> Iterator[TopicAccess]:
    """Yield the private output and the public name; strangers speak there where they may.

    Whoever obeys and is not in the plan listens to the public name: the supervisor stops it, too.
    """
    from_clients = topic.rpartition("/")[2] in ROS1_CLIENT_TOPICS if stream.action else True
    unplanned = (ANY_NODE,) if from_clients and not stream.block_unapproved else ()
    supervisor = (SUPERVISOR_NODE,) if stream.is_command else ()
    yield _access(stream, output_topic(topic), (node, *supervisor), subscribers)
    yield _access(stream, topic, (node, *supervisor, *unplanned), (ANY_NODE,))


def _access(
    stream: Stream, topic: str, publishers: tuple[str, ...], subscribers: tuple[str, ...]
) -> TopicAccess:
    return TopicAccess(
        topic=topic, stream_topic=stream.topic, publishers=publishers, subscribers=subscribers
    )
