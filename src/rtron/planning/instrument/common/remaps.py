"""Which remaps close the plan's enforced topics at both ends (paper section 5.1)."""

import re
import shlex
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.errors import InputError, PlanError, suggestion
from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.vocabulary import (
    ROS1_CLIENT_TOPICS,
    ROS1_SERVER_TOPICS,
    SERVER_FLOW,
    Flow,
    LaunchNode,
    LaunchTree,
    Mode,
    Plan,
    Ros2ActionEntity,
    Stream,
    build_streams,
    flow_topic,
    is_action_type,
    matches_node,
    output_topic,
    ros1_topic_name,
    ros2_entity_name,
)
from rtron.vocabulary.launch import resolve_name

_LEGAL_TOPIC = re.compile(r"(/[A-Za-z]\w*)+")


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamRole:
    """A node's part in a stream: the flow it publishes, if any, and whether it is a successor."""

    stream: Stream
    flow: Flow | None
    is_successor: bool

    @property
    def private_topics(self) -> Mapping[str, str]:
        """The private topics that the node's ends of the stream are moved to, by the public ones.

        A node that publishes and follows has one name for both: the guard serves it on its flow.
        An action of ROS 2 moves by its services and topics, below the action's private name.
        """
        action = self.stream.action
        if is_action_type(self.stream.type):
            private = self._client_name(action)
            return {
                ros2_entity_name(action, entity): ros2_entity_name(private, entity)
                for entity in Ros2ActionEntity
            }
        client_topics = (
            [ros1_topic_name(action, part) for part in ROS1_CLIENT_TOPICS]
            if action
            else [self.stream.topic]
        )
        server_topics = (
            [ros1_topic_name(action, part) for part in ROS1_SERVER_TOPICS] if action else []
        )
        return {
            **{topic: self._client_name(topic) for topic in client_topics},
            **{topic: self._server_name(topic) for topic in server_topics},
        }

    def _client_name(self, topic: str) -> str:
        return flow_topic(topic, self.flow.name) if self.flow else output_topic(topic)

    def _server_name(self, topic: str) -> str:
        return flow_topic(topic, SERVER_FLOW) if self.is_successor else output_topic(topic)


NodeRemaps = Mapping[LaunchNode, tuple[PlacedRemap, ...]]
"""The remaps that each node should get."""


def enforced_streams(plan: Plan) -> tuple[Stream, ...]:
    """Return the streams that the guard stands in; raise PlanError for an illegal topic."""
    enforced = tuple(stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE)
    for stream in enforced:
        for topic in (stream.topic, *(flow_topic(stream.topic, f.name) for f in stream.flows)):
            if not _LEGAL_TOPIC.fullmatch(topic):
                raise PlanError(f"'{topic}' is no name that a topic can have")
    return enforced


def plan_remaps(tree: LaunchTree, enforced: tuple[Stream, ...]) -> NodeRemaps:
    """Return the remaps to place on each launched node that has a side in an enforced stream."""
    roles = {node: tuple(_stream_roles(node, enforced)) for node in tree.nodes()}
    return {node: tuple(_remaps(node, found)) for node, found in roles.items() if found}


def public_names(stream: Stream) -> frozenset[str]:
    """Return the names that nodes have for a stream: its topic, or all of an action of ROS 2."""
    if is_action_type(stream.type):
        return frozenset(ros2_entity_name(stream.action, entity) for entity in Ros2ActionEntity)
    return frozenset({stream.topic})


def stream_role(node: LaunchNode, stream: Stream) -> StreamRole | None:
    """Return a launched node's side in a stream.

    The topics of a nodelet appear under its manager: a loader that the plan does not name itself
    has its manager's side.
    """
    manager = manager_of(node)
    return _role_by_name(node.name, stream) or (_role_by_name(manager, stream) if manager else None)


def planned_remaps(plan: Plan, node: str = "") -> tuple[tuple[str, str, str], ...]:
    """Return (node, public name, private name) without a launch, for all nodes or for one.

    `node` may be a name that a pattern of the plan means. InputError if the plan has no such node.
    """
    enforced = enforced_streams(plan)
    planned = _planned_nodes(enforced)
    if node and not any(matches_node(each, node) for each in planned):
        help = suggestion(node, planned) if planned else "no coordination node enforces"
        raise InputError(f"the plan has no node {node}", help=help)
    return tuple(
        (name, public, private)
        for name in ([node] if node else planned)
        for public, private in private_names(name, enforced).items()
    )


def _planned_nodes(enforced: tuple[Stream, ...]) -> tuple[str, ...]:
    """Return the nodes that have a side in an enforced stream, each once, as in the plan."""
    publishers = [flow.publisher for stream in enforced for flow in stream.flows]
    successors = [node for stream in enforced for node in stream.successors]
    return tuple(dict.fromkeys((*publishers, *successors)))


def private_names(name: str, enforced: tuple[Stream, ...]) -> Mapping[str, str]:
    """Return all private names of a node by the public ones; `name` is as in a plan."""
    roles = filter(None, (_role_by_name(name, stream) for stream in enforced))
    return {public: private for role in roles for public, private in role.private_topics.items()}


def _stream_roles(node: LaunchNode, enforced: tuple[Stream, ...]) -> Iterator[StreamRole]:
    return filter(None, (stream_role(node, stream) for stream in enforced))


def _role_by_name(name: str, stream: Stream) -> StreamRole | None:
    exact = (flow for flow in stream.flows if flow.publisher == name)
    matching = (flow for flow in stream.flows if matches_node(flow.publisher, name))
    flow = next(exact, None) or next(matching, None)
    is_successor = any(matches_node(successor, name) for successor in stream.successors)
    return (
        StreamRole(stream=stream, flow=flow, is_successor=is_successor)
        if flow or is_successor
        else None
    )


def _remaps(node: LaunchNode, roles: tuple[StreamRole, ...]) -> Iterator[PlacedRemap]:
    """Yield the remaps that take a node from public topics to its private ones.

    Remaps do not chain: one that leads to the public topic gets another target, under its own
    spelling, so that it is replaced; so are others of the same name, for which of two spellings
    counts depends on their order. A topic that the node's own remap takes elsewhere is left.
    """
    private = {topic: name for role in roles for topic, name in role.private_topics.items()}
    remapped = {remap.source for remap in node.remaps}
    replaced = {remap.source for remap in node.remaps if remap.target in private}
    for remap in node.remaps:
        if remap.source in replaced:
            target = private.get(remap.target, remap.written_target)
            yield PlacedRemap(
                node=node.name, topic=remap.target, written=remap.written_source, target=target
            )
    for topic in (topic for topic in private if topic not in remapped):
        yield PlacedRemap(node=node.name, topic=topic, written=topic, target=private[topic])


def manager_of(node: LaunchNode) -> str | None:
    """Return the manager that a node loads its nodelet into; None for every other node."""
    if (node.package, node.type) != ("nodelet", "nodelet"):
        return None
    match _words(node.args):
        case ["load", _, manager, *_]:
            return resolve_name(manager, node.name)
    return None


def loaders(nodes: Iterable[LaunchNode]) -> Mapping[str, list[LaunchNode]]:
    """Return the loaders of each manager."""
    by_manager: dict[str, list[LaunchNode]] = defaultdict(list)
    for node in nodes:
        manager = manager_of(node)
        if manager:
            by_manager[manager].append(node)
    return by_manager


def _words(args: str) -> list[str]:
    try:
        return shlex.split(args)
    except ValueError:
        return args.split()
