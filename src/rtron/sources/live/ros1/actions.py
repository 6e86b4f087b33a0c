"""Actions known by their five topics: who offers them and who calls them (actionlib)."""

from collections import defaultdict
from collections.abc import Iterable, Iterator

from rtron.vocabulary import Action, ActionRole, Direction, Endpoint

PARTS = frozenset({"goal", "cancel", "status", "feedback", "result"})
_ROLES = {"goal": ActionRole.CLIENT, "result": ActionRole.SERVER}


def actions_among(endpoints: Iterable[Endpoint]) -> tuple[Action, ...]:
    """Return the actions whose five topics are there, one entry for each node's side.

    Who publishes the goal is a client, who publishes the result is a server.
    """
    spaces: dict[str, list[tuple[str, Endpoint]]] = defaultdict(list)
    for endpoint in endpoints:
        space, _, part = endpoint.topic.rpartition("/")
        if part in PARTS:
            spaces[space].append((part, endpoint))
    whole = {n: ends for n, ends in spaces.items() if {part for part, _ in ends} == PARTS}
    return tuple(action for name, ends in whole.items() for action in _sides(name, ends))


def _sides(name: str, ends: list[tuple[str, Endpoint]]) -> Iterator[Action]:
    type = next((_action_type(end.type) for part, end in ends if part == "goal"), "")
    for part, end in ends:
        if part in _ROLES and end.direction is Direction.PUBLISH:
            yield Action(node=end.node, name=name, type=type, role=_ROLES[part])


def _action_type(goal_type: str) -> str:
    """Return the action's type, `pkg/NameAction` for a goal of `pkg/NameActionGoal`."""
    return goal_type.removesuffix("Goal") if goal_type.endswith("ActionGoal") else ""
