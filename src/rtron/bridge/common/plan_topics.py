"""Which topic of the graph a client's topic is: a guarded one is a private one of the plan.

So a client that commands is a flow of its own, and never publishes where the base listens.
"""

from collections.abc import Callable, Iterator

from rtron.bridge.rights.document import (
    ActionRight,
    BridgeRights,
    ClientRights,
    PublishRight,
    SubscribeRight,
    same_type,
)
from rtron.errors import InputError, WireError
from rtron.messages import VELOCITY_TYPES
from rtron.vocabulary import (
    PRIVATE_ROOT,
    Plan,
    Ros2ActionEntity,
    matches_node,
    normalise_type,
    ros2_entity_name,
)
from rtron.vocabulary.action import ROS1_CLIENT_TOPICS, Ros1ActionTopic, ros1_topic_name
from rtron.vocabulary.topic_access import list_service_access, list_topic_access

_LIMITS = ("std_msgs/Float32", "std_msgs/Float64")
"""Velocity types that say nothing where nobody guards them: most numbers are no speeds."""
_ACTION_TYPES = {
    Ros1ActionTopic.CANCEL: "actionlib_msgs/GoalID",
    Ros1ActionTopic.STATUS: "actionlib_msgs/GoalStatusArray",
}


class PlanTopics:
    """The names that a plan gives to the topics of a client's node."""

    def __init__(self, plan: Plan) -> None:
        self._access = list_topic_access(plan)
        self._services = list_service_access(plan)

    def published(self, node: str, topic: str, type: str) -> str:
        """Return the topic that a node publishes for one that it names.

        WireError if the plan guards it and has no flow of this node, or if it moves the robot and
        nobody guards it.
        """
        guarded = [each for each in self._access if _is_part(each.topic, topic)]
        for each in guarded:
            is_private = each.topic.startswith(f"{PRIVATE_ROOT}/")
            if is_private and each.may_publish(node):
                return each.topic
        if guarded:
            raise WireError(f"the plan guards {topic} and has no flow of {node}")
        if normalise_type(type) in VELOCITY_TYPES and normalise_type(type) not in _LIMITS:
            raise WireError(f"{topic} moves the robot, and no plan guards it")
        return topic

    def listeners(self, name: str) -> tuple[str, ...]:
        """Return the guard's nodes that alone hear a private topic; none for other topics."""
        if not name.startswith(f"{PRIVATE_ROOT}/"):
            return ()
        return next((each.subscribers for each in self._access if each.topic == name), ())

    def action(self, node: str, action: str) -> str:
        """Return the action of ROS 2 that a node sends goals to for one that it names.

        WireError if the plan guards it and has no flow of this node.
        """
        goals = ros2_entity_name(action, Ros2ActionEntity.SEND_GOAL)
        names = {each.service: each for each in self._services if each.stream_topic == action}
        if not names:
            return action
        ending = goals.removeprefix(action)
        for service, access in names.items():
            is_flow = service.startswith(f"{PRIVATE_ROOT}{action}/") and service.endswith(ending)
            if is_flow and any(matches_node(name, node) for name in access.clients):
                return service.removesuffix(ending)
        raise WireError(f"the plan guards {action} and has no flow of {node}")

    def subscribed(self, node: str, topic: str) -> str:
        """Return the topic that a node subscribes for one that it names.

        The guard publishes what it lets pass under the public name, too, for all who look on.
        """
        parts = (each for each in self._access if _is_part(each.topic, topic))
        return next((each.topic for each in parts if each.may_subscribe(node)), topic)


def _is_part(name: str, topic: str) -> bool:
    """Tell whether a name is a topic itself, or one of its private ones."""
    return name == topic or name.rpartition("/")[0] == PRIVATE_ROOT + topic


def published_topics(client: ClientRights, ros: int) -> tuple[PublishRight, ...]:
    """Return what a client may publish, in ROS 1 with those topics of its actions."""
    return (
        *client.publish,
        *(
            PublishRight(
                topic=topic,
                type=type,
                rate=right.rate,
                approval=right.approval and _action_part(topic) is Ros1ActionTopic.GOAL,
            )
            for topic, type, right in _action_topics(client, ros)
            if _action_part(topic) in ROS1_CLIENT_TOPICS
        ),
    )


def subscribed_topics(client: ClientRights, ros: int) -> tuple[SubscribeRight, ...]:
    """Return what a client may read, in ROS 1 with those topics of its actions."""
    return (
        *client.subscribe,
        *(
            SubscribeRight(topic=topic, type=type)
            for topic, type, _ in _action_topics(client, ros)
            if _action_part(topic) not in ROS1_CLIENT_TOPICS
        ),
    )


def topic_rights(client: ClientRights, ros: int) -> tuple[PublishRight | SubscribeRight, ...]:
    """Return all that a client may publish or read."""
    return (*published_topics(client, ros), *subscribed_topics(client, ros))


def _action_topics(client: ClientRights, ros: int) -> Iterator[tuple[str, str, ActionRight]]:
    """Yield the topics of a client's actions, with types and rights (ROS wiki: actionlib)."""
    for right in client.actions if ros == 1 else ():
        for part in Ros1ActionTopic:
            type = _ACTION_TYPES.get(part, f"{right.type}{part.value.capitalize()}")
            yield ros1_topic_name(right.action, part), type, right


def _action_part(topic: str) -> Ros1ActionTopic:
    return Ros1ActionTopic(topic.rpartition("/")[2])


def check_rights(rights: BridgeRights, plan: Plan, path: str = "bridge.yaml") -> None:
    """Raise one InputError that tells which rights the plan does not let anybody have."""
    problems = list(_problems(rights, plan))
    if problems:
        help = "name the client's node as a publisher of a flow, or take the right away"
        raise InputError("\n".join(problems), path=path, help=help)


def _problems(rights: BridgeRights, plan: Plan) -> Iterator[str]:
    topics = PlanTopics(plan)
    for client in rights.clients:
        for right in client.actions if plan.ros != 1 else ():
            yield from _refusal(client, topics.action, right.action)
        for publish in published_topics(client, plan.ros):
            yield from _refusal(client, topics.published, publish.topic, publish.type)
            if publish.approval and normalise_type(publish.type) in VELOCITY_TYPES:
                why = "nobody can approve each velocity: have the lease approved by a person"
                yield f"{client.name}: {publish.topic}: {why}"
    yield from _other_types(rights, plan.ros)


def _other_types(rights: BridgeRights, ros: int) -> Iterator[str]:
    """Yield each topic that two rights have with different types: one would read the other's."""
    types: dict[str, tuple[str, str]] = {}
    for client in rights.clients:
        for right in topic_rights(client, ros):
            type, first = types.setdefault(right.topic, (right.type, client.name))
            if not same_type(type, right.type):
                yield f"{client.name}: {right.topic} is {right.type} here, {type} for {first}"


def _refusal(client: ClientRights, find: Callable[..., str], *name: str) -> Iterator[str]:
    """Yield why a client cannot have a topic or an action, if that is so."""
    try:
        find(client.node, *name)
    except WireError as error:
        yield f"{client.name}: {error}"
