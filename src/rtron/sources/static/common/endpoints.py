"""From what a node declares to its endpoints: remaps, actions, simulated time."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.vocabulary import (
    Action,
    ActionRole,
    Direction,
    Endpoint,
    Evidence,
    Resolution,
    Service,
)

DIRECTIONS = {
    DeclarationKind.PUBLISH: Direction.PUBLISH,
    DeclarationKind.SUBSCRIBE: Direction.SUBSCRIBE,
}
ROLES = {
    DeclarationKind.ACTION_CLIENT: ActionRole.CLIENT,
    DeclarationKind.ACTION_SERVER: ActionRole.SERVER,
}
_FROM_CLIENT = ("goal", "cancel")
_PARTS = {
    "goal": "{}Goal",
    "cancel": "actionlib_msgs/GoalID",
    "status": "actionlib_msgs/GoalStatusArray",
    "feedback": "{}Feedback",
    "result": "{}Result",
}
_CLOCK = "/clock"


@dataclass(frozen=True, slots=True)
class Remapping:
    """A process's remaps; they compare whole names, and the last of a name counts."""

    targets: Mapping[str, str]

    def __call__(self, name: str) -> str:
        """Return the name that a declared name stands for."""
        return self.targets.get(name, name)


def endpoints_of(node: str, declared: Declaration, remap: Remapping) -> Iterator[Endpoint]:
    """Yield the topics of a declaration; an action has five (actionlib's wiki page)."""
    if declared.kind in DIRECTIONS:
        direction = DIRECTIONS[declared.kind]
        yield _endpoint(node, declared, declared.name, direction, declared.type, remap)
    elif declared.kind in ROLES:
        for part, type in _PARTS.items():
            publishes = (part in _FROM_CLIENT) == (declared.kind is DeclarationKind.ACTION_CLIENT)
            direction = Direction.PUBLISH if publishes else Direction.SUBSCRIBE
            name = f"{declared.name}/{part}"
            yield _endpoint(node, declared, name, direction, _part_type(type, declared.type), remap)


def service_of(node: str, declared: Declaration, remap: Remapping) -> Iterator[Service]:
    """Yield the service that a declaration offers."""
    if declared.kind is DeclarationKind.SERVICE:
        yield Service(node=node, name=remap(declared.name), type=declared.type)


def action_of(node: str, declared: Declaration, remap: Remapping) -> Iterator[Action]:
    """Yield a declaration's side of an action, by the name that its goals go to."""
    if declared.kind in ROLES:
        name = remap(f"{declared.name}/goal").removesuffix("/goal")
        role = ROLES[declared.kind]
        yield Action(node=node, name=name, type=declared.type, role=role)


def clock_of(node: str, place: Evidence) -> Endpoint:
    """Return the subscription by which a node follows simulated time (ROS wiki: Clock)."""
    return Endpoint(
        node=node,
        topic=_CLOCK,
        direction=Direction.SUBSCRIBE,
        type="rosgraph_msgs/Clock",
        declared_name=_CLOCK,
        implicit=True,
        evidence=(place,),
    )


def _endpoint(
    node: str,
    declared: Declaration,
    name: str,
    direction: Direction,
    type: str,
    remap: Remapping,
) -> Endpoint:
    topic = remap(name)
    return Endpoint(
        node=node,
        topic=topic,
        direction=direction,
        type=type,
        declared_name=name,
        implicit=declared.implicit or declared.kind in ROLES,
        resolution=Resolution.SYMBOLIC if "{" in topic else declared.resolution,
        evidence=declared.evidence,
    )


def _part_type(pattern: str, action: str) -> str:
    return pattern.format(action) if action or "{}" not in pattern else ""
