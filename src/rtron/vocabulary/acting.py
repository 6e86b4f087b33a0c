"""An app of ROS 2 seen as one of ROS 1: the goals of an action as a topic of the action's name."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

from rtron.vocabulary.enums import ActionRole, Direction
from rtron.vocabulary.graph import Action, Endpoint, InteractionGraph

_ROS2 = 2


def with_goals(graph: InteractionGraph) -> InteractionGraph:
    """Return a graph in which an action's clients publish it, and its servers subscribe it.

    That is what goals are in ROS 1, where the graph says so itself. A node that serves what it asks
    for hears itself, which nobody can stand between: it is no publisher.
    """
    if graph.ros != _ROS2 or not graph.actions:
        return graph
    return replace(graph, endpoints=(*graph.endpoints, *_goals(graph)))


def _goals(graph: InteractionGraph) -> Iterator[Endpoint]:
    known = {topic.name for topic in graph.topics}
    known.update(endpoint.topic for endpoint in graph.endpoints)
    servers = defaultdict(set)
    for side in graph.actions:
        if side.role is ActionRole.SERVER:
            servers[side.name].add(side.node)
    for side in dict.fromkeys(graph.actions):
        serves = side.role is ActionRole.SERVER
        if side.name not in known and (serves or side.node not in servers[side.name]):
            yield _end(side, Direction.SUBSCRIBE if serves else Direction.PUBLISH)


def _end(side: Action, direction: Direction) -> Endpoint:
    return Endpoint(
        node=side.node,
        topic=side.name,
        direction=direction,
        type=side.type,
        declared_name=side.name,
    )
