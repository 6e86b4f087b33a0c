"""Actions, each as one unit for each node's side, made of what hides below `_action`.

A node is a server if it offers one of the three services or publishes one of the two topics, a
client if it can call one of the services (design.ros2.org: actions). Who only listens to feedback
or status is neither. What has such a name and another type is no part of an action.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from rtron.vocabulary import Action, ActionRole, Direction, Ros2ActionEntity, is_action_type
from rtron.wire.ros2.endpoints import Ros2Endpoint

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.sources.live.ros2.domain import Snapshot
    from rtron.wire.ros2.endpoints import Ros2ServiceEndpoint

_ENTITY_BY_SUFFIX = {f"/_action/{end}": end for end in Ros2ActionEntity}
_TYPE_SUFFIXES = {
    Ros2ActionEntity.SEND_GOAL: "_SendGoal",
    Ros2ActionEntity.GET_RESULT: "_GetResult",
    Ros2ActionEntity.FEEDBACK: "_FeedbackMessage",
}
_COMMON_TYPES = {
    Ros2ActionEntity.CANCEL_GOAL: "action_msgs/srv/CancelGoal",
    Ros2ActionEntity.STATUS: "action_msgs/msg/GoalStatusArray",
}
_T = TypeVar("_T", Ros2Endpoint, "Ros2ServiceEndpoint")


@dataclass(frozen=True, slots=True)
class ActionMember:
    """An action that an end belongs to, and its type if that end tells it."""

    action: str
    type: str


def find_actions(snapshot: Snapshot) -> tuple[Action, ...]:
    """Return the actions, one entry for each node's side and each type that its ends tell."""
    sides: dict[tuple[str, str, ActionRole], set[str]] = {}
    for node, member, role in _node_members(snapshot):
        sides.setdefault((node, member.action, role), set()).add(member.type)
    known = _types_by_action(sides)
    return tuple(
        Action(node=node, name=name, type=type, role=role)
        for (node, name, role), types in sorted(sides.items())
        for type in sorted(filter(None, types)) or [known.get(name, "")]
    )


def outside_of_actions(endpoints: Iterable[_T], actions: Iterable[Action]) -> list[_T]:
    """Return the ends that are not those of a node's side of an action."""
    sides = {(action.node, action.name) for action in actions}
    members = (
        (endpoint, action_member(_name_of(endpoint), endpoint.type)) for endpoint in endpoints
    )
    return [
        endpoint
        for endpoint, member in members
        if not member or (endpoint.node, member.action) not in sides
    ]


def action_member(name: str, type: str) -> ActionMember | None:
    """Return what a topic or service is a part of, by its name and type; None if of no action."""
    action, suffix, name_of_entity = name.rpartition("/_action/")
    endpoint = _ENTITY_BY_SUFFIX.get(suffix + name_of_entity)
    if not endpoint or not action:
        return None
    if endpoint in _COMMON_TYPES:
        return ActionMember(action, "") if type == _COMMON_TYPES[endpoint] else None
    action_type = type.removesuffix(_TYPE_SUFFIXES[endpoint])
    return (
        ActionMember(action, action_type)
        if action_type != type and is_action_type(action_type)
        else None
    )


def _node_members(snapshot: Snapshot) -> Iterator[tuple[str, ActionMember, ActionRole]]:
    for endpoint in snapshot.endpoints:
        member = action_member(endpoint.topic, endpoint.type)
        if member and endpoint.direction is Direction.PUBLISH:
            yield endpoint.node, member, ActionRole.SERVER
    for service in snapshot.services:
        member = action_member(service.service, service.type)
        if member:
            yield (
                service.node,
                member,
                ActionRole.SERVER if service.is_server else ActionRole.CLIENT,
            )


def _types_by_action(sides: dict[tuple[str, str, ActionRole], set[str]]) -> dict[str, str]:
    """Return the type of each action that some end tells."""
    types_by_name = (
        (name, type) for (_, name, _), types in sides.items() for type in types if type
    )
    return dict(sorted(types_by_name, reverse=True))


def _name_of(endpoint: Ros2Endpoint | Ros2ServiceEndpoint) -> str:
    return endpoint.topic if isinstance(endpoint, Ros2Endpoint) else endpoint.service
