"""What a plan says about who speaks to whom in ROS 2: its topics, and its actions' services.

A service is two topics to the middleware, a request and a reply, whose names no ROS name begins
like (design.ros2.org: Topic and Service name mapping to DDS); they are kept by those names.
"""

from collections.abc import Iterator

from rtron.guard.audit.common.guard_inputs import GuardInput, allows_anybody, matches_any
from rtron.guard.lanes.assignment import lane_nodes
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    Mode,
    Plan,
    Ros2ActionEntity,
    ServiceAccess,
    Stream,
    TopicAccess,
    build_streams,
    flow_topic,
    list_service_access,
    list_topic_access,
    normalise_type,
    output_topic,
    ros2_entity_name,
    stage_nodes,
)
from rtron.vocabulary.topic_access import ANY_NODE
from rtron.wire.ros2.service_names import reply_topic, request_topic, ros_name

_COMMAND_SERVICES = (Ros2ActionEntity.SEND_GOAL, Ros2ActionEntity.CANCEL_GOAL)


class ExpectedGraph:
    """Who may speak on each topic that an enforced stream has closed.

    `enforcing_nodes` are the guard's nodes on these streams, `guard_nodes` all of its nodes and the
    supervisor's.
    `outputs` are the private outputs by their public names, `types` the streams' types by theirs.
    `lanes` are the nodes of the command process and of the bulk process. `celled` are the streams
    that lead into cells alone: nobody outside can speak to those behind them.
    """

    def __init__(self, plan: Plan) -> None:
        enforced = [stream for stream in build_streams(plan) if stream.mode is Mode.ENFORCE]
        actions = [stream for stream in enforced if stream.is_ros2_action]
        self.actions = frozenset(stream.topic for stream in actions)
        closed = frozenset(stream.topic for stream in actions if stream.block_unapproved)
        planned = (*list_topic_access(plan), *_service_topics(plan, closed))
        self.topics = {topic.topic: topic for topic in planned}
        self.inputs = tuple(way for stream in enforced for way in _inputs(stream))
        self.outputs = dict(pair for stream in enforced for pair in _outputs(stream))
        self._cells = plan.cell
        self.celled = frozenset(
            each.topic
            for each in enforced
            if each.successors and all(map(self.is_in_cell, each.successors))
        )
        self.types = {each.topic: normalise_type(each.type) for each in enforced}
        self.enforcing_nodes = frozenset(
            {GUARD_NODE, BULK_NODE, *(node for stream in enforced for node in stage_nodes(stream))}
        )
        self.guard_nodes = self.enforcing_nodes.union(
            {SUPERVISOR_NODE}, *map(stage_nodes, build_streams(plan))
        )
        self.lanes = lane_nodes(plan)
        named = {name for t in self.topics.values() for name in (*t.publishers, *t.subscribers)}
        self._planned_nodes = tuple(sorted(named - self.guard_nodes - {ANY_NODE}))

    def private_topics(self) -> Iterator[TopicAccess]:
        """Yield the topics that only the guard and those whom it stands between know."""
        return (t for t in self.topics.values() if ros_name(t.topic).startswith(PRIVATE_ROOT + "/"))

    def is_planned(self, node: str) -> bool:
        """Tell whether a node is one that the guard stands before or behind."""
        return node not in self.guard_nodes and matches_any(self._planned_nodes, node)

    def is_in_cell(self, node: str) -> bool:
        """Tell whether a node, or each that a pattern of the plan means, is in a cell."""
        return node in self._cells

    def is_successor(self, node: str) -> bool:
        """Tell whether a node is behind the guard: what it is told moves the robot."""
        outputs = (self.topics[private] for private in self.outputs.values())
        return node not in self.guard_nodes and any(topic.may_subscribe(node) for topic in outputs)

    def planned_type(self, topic: TopicAccess) -> str:
        """Return the type that the plan wants on a topic, in ROS 1's spelling; "" if any."""
        return "" if topic.stream_topic in self.actions else self.types.get(topic.stream_topic, "")

    def has_consumers_outside_guard(self, topic: TopicAccess) -> bool:
        """Tell whether others than the guard rely on what is said on a topic."""
        return not allows_anybody(topic) and any(
            name not in self.guard_nodes for name in topic.subscribers
        )


def _outputs(stream: Stream) -> Iterator[tuple[str, str]]:
    if not stream.is_ros2_action:
        yield stream.topic, output_topic(stream.topic)
        return
    for part in _COMMAND_SERVICES:
        public, private = stream.topic, output_topic(stream.topic)
        yield (
            request_topic(ros2_entity_name(public, part)),
            request_topic(ros2_entity_name(private, part)),
        )


def _inputs(stream: Stream) -> Iterator[GuardInput]:
    for flow in stream.flows:
        public, private = stream.topic, flow_topic(stream.topic, flow.name)
        names = [(public, private)]
        if stream.is_ros2_action:
            pairs = [
                (ros2_entity_name(public, each), ros2_entity_name(private, each))
                for each in _COMMAND_SERVICES
            ]
            names = [(request_topic(one), request_topic(other)) for one, other in pairs]
        for public_name, private_name in names:
            yield GuardInput(public=public_name, private=private_name, publishers=(flow.publisher,))


def _service_topics(plan: Plan, closed: frozenset[str]) -> Iterator[TopicAccess]:
    """Yield the requests and replies of the actions' services.

    Who only asks for a result moves nothing. `closed` are the actions that strangers may not use.
    """
    for each in list_service_access(plan):
        public = each.service.startswith(f"{each.stream_topic}/")
        clients = each.servers if public and each.stream_topic in closed else each.clients
        if not each.service.endswith(Ros2ActionEntity.GET_RESULT):
            yield _planned_topic(each, request_topic(each.service), clients, each.servers)
        yield _planned_topic(each, reply_topic(each.service), each.servers, clients)


def _planned_topic(
    service: ServiceAccess, topic: str, publishers: tuple[str, ...], subscribers: tuple[str, ...]
) -> TopicAccess:
    guarded = service.stream_topic
    return TopicAccess(
        topic=topic, stream_topic=guarded, publishers=publishers, subscribers=subscribers
    )
