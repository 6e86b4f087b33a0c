"""Actions known by their five topics: who offers them and who calls them (actionlib)."""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from rtron.vocabulary import Action, ActionRole, Direction, Endpoint

ACTION_TOPICS = frozenset({"goal", "cancel", "status", "feedback", "result"})
_ROLES = {"goal": ActionRole.CLIENT, "result": ActionRole.SERVER}


def find_actions(endpoints: Iterable[Endpoint]) -> tuple[Action, ...]:
    """Return the actions whose five topics are there, one entry for each node's side.

    Who publishes the goal is a client, who publishes the result is a server.
    """
    namespaces: dict[str, list[tuple[str, Endpoint]]] = defaultdict(list)
    for endpoint in endpoints:
        namespace, _, part = endpoint.topic.rpartition("/")
        if part in ACTION_TOPICS:
            namespaces[namespace].append((part, endpoint))
    complete = {
        n: members
        for n, members in namespaces.items()
        if {part for part, _ in members} == ACTION_TOPICS
    }
    return tuple(
        action for name, members in complete.items() for action in _node_actions(name, members)
    )


def _node_actions(name: str, members: list[tuple[str, Endpoint]]) -> Iterator[Action]:
    type = next((_action_type(endpoint.type) for part, endpoint in members if part == "goal"), "")
    for part, endpoint in members:
        if part in _ROLES and endpoint.direction is Direction.PUBLISH:
            yield Action(node=endpoint.node, name=name, type=type, role=_ROLES[part])


def _action_type(goal_type: str) -> str:
    """Return the action's type, `pkg/NameAction` for a goal of `pkg/NameActionGoal`."""
    return goal_type.removesuffix("Goal") if goal_type.endswith("ActionGoal") else ""
