"""An app of ROS 2 seen as one of ROS 1: the goals of an action as a topic of the action's name."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

from rtron.vocabulary.enums import ActionRole, Direction
from rtron.vocabulary.graph import Action, Endpoint, InteractionGraph

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
