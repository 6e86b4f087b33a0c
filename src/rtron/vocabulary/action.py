"""An action as one unit: actionlib's five topics, or ROS 2's three services and two topics.

Of an action of ROS 1 the goals are a topic, `<action>/goal` (ROS wiki: actionlib). In ROS 2 they
are requests, so there the action's own name stands for them (design.ros2.org: actions).
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

from rtron.vocabulary.enums import ActionRole, Direction, StringEnum
from rtron.vocabulary.graph import Action, Endpoint, InteractionGraph
from rtron.vocabulary.names import normalise_type

_ACTION_TYPE = re.compile(r"[A-Za-z]\w*/action/[A-Za-z][A-Za-z0-9]*", re.ASCII)


class Ros1ActionTopic(StringEnum):
    """The topics of an action of ROS 1: clients publish the first two, the server the others."""

    GOAL = "goal"
    CANCEL = "cancel"
    STATUS = "status"
    FEEDBACK = "feedback"
    RESULT = "result"


class Ros2ActionEntity(StringEnum):
    """What an action of ROS 2 is made of: three services of the server, and two topics."""

    SEND_GOAL = "send_goal"
    CANCEL_GOAL = "cancel_goal"
    GET_RESULT = "get_result"
    FEEDBACK = "feedback"
    STATUS = "status"


ROS1_CLIENT_TOPICS = (Ros1ActionTopic.GOAL, Ros1ActionTopic.CANCEL)
ROS1_SERVER_TOPICS = (Ros1ActionTopic.STATUS, Ros1ActionTopic.FEEDBACK, Ros1ActionTopic.RESULT)
ROS2_ACTION_SERVICES = (
    Ros2ActionEntity.SEND_GOAL,
    Ros2ActionEntity.CANCEL_GOAL,
    Ros2ActionEntity.GET_RESULT,
)
ROS2_ACTION_TOPICS = (Ros2ActionEntity.FEEDBACK, Ros2ActionEntity.STATUS)
SERVER_FLOW = "server"
"""The flow of an action's server on the three topics that it publishes."""


def action_name(topic: str, type: str) -> str:
    """Return the action whose goals a topic carries, or nothing; in ROS 2 it is the topic."""
    if is_action_type(type):
        return topic
    has_goals = normalise_type(type).endswith("ActionGoal") and topic.endswith("/goal")
    return topic.removesuffix("/goal") if has_goals else ""


def is_action_type(type: str) -> bool:
    """Tell whether a type is that of an action of ROS 2, like `nav2_msgs/action/Spin`."""
    return _ACTION_TYPE.fullmatch(type) is not None


def ros1_topic_name(action: str, part: Ros1ActionTopic) -> str:
    """Return the public name of one of an action's topics in ROS 1."""
    return f"{action}/{part}"


def ros2_entity_name(action: str, entity: Ros2ActionEntity) -> str:
    """Return the name of one of an action's services and topics in ROS 2."""
    return f"{action}/_action/{entity}"


_ROS2 = 2


def with_goal_topics(graph: InteractionGraph) -> InteractionGraph:
    """Return a graph in which an action's clients publish it, and its servers subscribe it.

    That is what goals are in ROS 1, where the graph says so itself. A node that serves what it asks
    for hears itself, which nobody can stand between: it is no publisher.
    """
    if graph.ros != _ROS2 or not graph.actions:
        return graph
    return replace(graph, endpoints=(*graph.endpoints, *_goal_endpoints(graph)))


def _goal_endpoints(graph: InteractionGraph) -> Iterator[Endpoint]:
    known_topics = {topic.name for topic in graph.topics}
    known_topics.update(endpoint.topic for endpoint in graph.endpoints)
    servers = defaultdict(set)
    for action in graph.actions:
        if action.role is ActionRole.SERVER:
            servers[action.name].add(action.node)
    for action in dict.fromkeys(graph.actions):
        is_server = action.role is ActionRole.SERVER
        if action.name not in known_topics and (
            is_server or action.node not in servers[action.name]
        ):
            yield _goal_endpoint(action, Direction.SUBSCRIBE if is_server else Direction.PUBLISH)


def _goal_endpoint(action: Action, direction: Direction) -> Endpoint:
    return Endpoint(
        node=action.node,
        topic=action.name,
        direction=direction,
        type=action.type,
        declared_name=action.name,
    )
