"""Actions, each as one unit for each node's side, made of what hides below `_action`.

A node is a server if it offers one of the three services or publishes one of the two topics, a
client if it can call one of the services (design.ros2.org: actions). Who only listens to feedback
or status is neither. What has such a name and another type is no part of an action.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from rtron.vocabulary import (
    Action,
    ActionEnd,
    ActionRole,
    Direction,
    is_action_type,
)
from rtron.wire.ros2.endpoints import Ros2Endpoint

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.sources.live.ros2.domain import Snapshot
    from rtron.wire.ros2.service_endpoints import Ros2ServiceEnd

_ENDS = {f"/_action/{end}": end for end in ActionEnd}
_OF_THE_ACTION = {
    ActionEnd.SEND_GOAL: "_SendGoal",
    ActionEnd.GET_RESULT: "_GetResult",
    ActionEnd.FEEDBACK: "_FeedbackMessage",
}
_OF_ALL = {
    ActionEnd.CANCEL_GOAL: "action_msgs/srv/CancelGoal",
    ActionEnd.STATUS: "action_msgs/msg/GoalStatusArray",
}
_T = TypeVar("_T", Ros2Endpoint, "Ros2ServiceEnd")


@dataclass(frozen=True, slots=True)
class Part:
    """An action that an end belongs to, and its type if that end tells it."""

    action: str
    type: str


def actions_among(seen: Snapshot) -> tuple[Action, ...]:
    """Return the actions, one entry for each node's side and each type that its ends tell."""
    sides: dict[tuple[str, str, ActionRole], set[str]] = {}
    for node, part, role in _sides(seen):
        sides.setdefault((node, part.action, role), set()).add(part.type)
    known = _types(sides)
    return tuple(
        Action(node=node, name=name, type=type, role=role)
        for (node, name, role), types in sorted(sides.items())
        for type in sorted(filter(None, types)) or [known.get(name, "")]
    )


def others(ends: Iterable[_T], actions: Iterable[Action]) -> list[_T]:
    """Return the ends that are not those of a node's side of an action."""
    sides = {(action.node, action.name) for action in actions}
    parts = ((end, part_of(_name(end), end.type)) for end in ends)
    return [end for end, part in parts if not part or (end.node, part.action) not in sides]


def part_of(name: str, type: str) -> Part | None:
    """Return what a topic or service is a part of, by its name and type; None if of no action."""
    action, below, last = name.rpartition("/_action/")
    end = _ENDS.get(below + last)
    if not end or not action:
        return None
    if end in _OF_ALL:
        return Part(action, "") if type == _OF_ALL[end] else None
    whole = type.removesuffix(_OF_THE_ACTION[end])
    return Part(action, whole) if whole != type and is_action_type(whole) else None


def _sides(seen: Snapshot) -> Iterator[tuple[str, Part, ActionRole]]:
    for end in seen.endpoints:
        part = part_of(end.topic, end.type)
        if part and end.direction is Direction.PUBLISH:
            yield end.node, part, ActionRole.SERVER
    for service in seen.services:
        part = part_of(service.service, service.type)
        if part:
            yield service.node, part, ActionRole.SERVER if service.serves else ActionRole.CLIENT


def _types(sides: dict[tuple[str, str, ActionRole], set[str]]) -> dict[str, str]:
    """Return the type of each action that some end tells."""
    told = ((name, type) for (_, name, _), types in sides.items() for type in types if type)
    return dict(sorted(told, reverse=True))


def _name(end: Ros2Endpoint | Ros2ServiceEnd) -> str:
    return end.topic if isinstance(end, Ros2Endpoint) else end.service
