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
    ServiceClient,
)

DIRECTIONS = {
    DeclarationKind.PUBLISH: Direction.PUBLISH,
    DeclarationKind.SUBSCRIBE: Direction.SUBSCRIBE,
}
ROLES = {
    DeclarationKind.ACTION_CLIENT: ActionRole.CLIENT,
    DeclarationKind.ACTION_SERVER: ActionRole.SERVER,
}
_CLIENT_TOPICS = ("goal", "cancel")
_ACTION_TOPIC_TYPES = {
    "goal": "{}Goal",
    "cancel": "actionlib_msgs/GoalID",
    "status": "actionlib_msgs/GoalStatusArray",
    "feedback": "{}Feedback",
    "result": "{}Result",
}
_CLOCK_TOPIC = "/clock"


@dataclass(frozen=True, slots=True)
class ProcessRemaps:
    """A process's remaps; they compare whole names, and the last of a name counts.

    In roscpp an action's topics lie below a node handle, whose own name is remapped, too
    (ros_comm: node_handle.cpp); in rospy they do not.
    """

    targets: Mapping[str, str]
    is_roscpp: bool = False

    def __call__(self, name: str) -> str:
        """Return the name that a declared name stands for."""
        return self.targets.get(name, name)

    def action_topic(self, action: str, part: str) -> str:
        """Return the topic that a part of a declared action stands for."""
        return self(f"{self(action) if self.is_roscpp else action}/{part}")


def declared_endpoints(
    node: str, declared: Declaration, remap: ProcessRemaps
) -> Iterator[Endpoint]:
    """Yield the topics of a declaration; an action has five (actionlib's wiki page)."""
    if declared.kind in DIRECTIONS:
        direction = DIRECTIONS[declared.kind]
        name, topic = declared.name, remap(declared.name)
        yield _endpoint(node, declared, name, topic, direction, declared.type)
    elif declared.kind in ROLES:
        for part, type in _ACTION_TOPIC_TYPES.items():
            publishes = (part in _CLIENT_TOPICS) == (declared.kind is DeclarationKind.ACTION_CLIENT)
            direction = Direction.PUBLISH if publishes else Direction.SUBSCRIBE
            name, topic = f"{declared.name}/{part}", remap.action_topic(declared.name, part)
            part_type = _part_type(type, declared.type)
            yield _endpoint(node, declared, name, topic, direction, part_type)


def declared_service_sides(
    node: str, declared: Declaration, remap: ProcessRemaps
) -> Iterator[Service | ServiceClient]:
    """Yield the service that a declaration offers or calls."""
    name, implicit = remap(declared.name), declared.implicit
    if declared.kind is DeclarationKind.SERVICE:
        yield Service(node=node, name=name, type=declared.type)
    elif declared.kind is DeclarationKind.SERVICE_CLIENT:
        yield ServiceClient(node=node, name=name, type=declared.type, implicit=implicit)


def declared_action(node: str, declared: Declaration, remap: ProcessRemaps) -> Iterator[Action]:
    """Yield a declaration's side of an action, by the name that its goals go to."""
    if declared.kind in ROLES:
        name = remap.action_topic(declared.name, "goal").removesuffix("/goal")
        role = ROLES[declared.kind]
        yield Action(node=node, name=name, type=declared.type, role=role)


def clock_subscription(node: str, location: Evidence) -> Endpoint:
    """Return the subscription by which a node follows simulated time (ROS wiki: Clock)."""
    return Endpoint(
        node=node,
        topic=_CLOCK_TOPIC,
        direction=Direction.SUBSCRIBE,
        type="rosgraph_msgs/Clock",
        declared_name=_CLOCK_TOPIC,
        implicit=True,
        evidence=(location,),
    )


def _endpoint(
    node: str, declared: Declaration, name: str, topic: str, direction: Direction, type: str
) -> Endpoint:
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
