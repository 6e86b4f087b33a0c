"""The DDS topics behind a right: a permission of DDS-Security knows nothing of ROS.

See design.ros2.org: Topic and Service name mapping to DDS; actions.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fnmatch import fnmatchcase

from rtron.security.access.rights import AccessRight, RightKind
from rtron.vocabulary import ROS2_ACTION_SERVICES, ROS2_ACTION_TOPICS, ros2_entity_name
from rtron.wire.ros2.service_names import reply_topic, request_topic

DISCOVERY_INFO = "ros_discovery_info"
"""Where each participant tells its nodes (rmw_dds_common); whoever speaks ROS 2 needs both ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DdsRights:
    """The DDS topics that a process may write and read: names, or patterns with `*`."""

    publish: frozenset[str]
    subscribe: frozenset[str]

    def without(self, other: "DdsRights") -> "DdsRights":
        """Return what is allowed here and is not covered by the other."""
        return DdsRights(
            publish=_uncovered(self.publish, other.publish),
            subscribe=_uncovered(self.subscribe, other.subscribe),
        )

    def described(self) -> tuple[str, ...]:
        """Return what is allowed as words, in order."""
        written = (f"publish {name}" for name in sorted(self.publish))
        return (*written, *(f"subscribe {name}" for name in sorted(self.subscribe)))

    def __bool__(self) -> bool:
        return bool(self.publish or self.subscribe)


NO_RIGHTS = DdsRights(publish=frozenset(), subscribe=frozenset())


def dds_rights(rights: Iterable[AccessRight]) -> DdsRights:
    """Return the DDS topics behind rights, with those that each participant needs."""
    publish, subscribe = {DISCOVERY_INFO}, {DISCOVERY_INFO}
    for right in rights:
        written, read = _topics(right)
        publish.update(written)
        subscribe.update(read)
    return DdsRights(publish=frozenset(publish), subscribe=frozenset(subscribe))


def _topics(right: AccessRight) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the topics that a right lets a process write, and those that it lets it read."""
    name = right.name
    match right.kind:
        case RightKind.PUBLISH:
            return (_topic(name),), ()
        case RightKind.SUBSCRIBE:
            return (), (_topic(name),)
        case RightKind.REPLY:
            return (reply_topic(name),), (request_topic(name),)
        case RightKind.REQUEST:
            return (request_topic(name),), (reply_topic(name),)
        case RightKind.EXECUTE:
            replies, requests = _action_services(name)
            return (*replies, *_action_topics(name)), tuple(requests)
        case RightKind.CALL:
            replies, requests = _action_services(name)
            return tuple(requests), (*replies, *_action_topics(name))


def _topic(name: str) -> str:
    return f"rt{name}"


def _action_services(action: str) -> tuple[list[str], list[str]]:
    """Return the topics of an action's replies, and those of its requests."""
    names = [ros2_entity_name(action, each) for each in ROS2_ACTION_SERVICES]
    return list(map(reply_topic, names)), list(map(request_topic, names))


def _action_topics(action: str) -> Iterator[str]:
    return (_topic(ros2_entity_name(action, each)) for each in ROS2_ACTION_TOPICS)


def _uncovered(names: frozenset[str], patterns: frozenset[str]) -> frozenset[str]:
    wild = [pattern for pattern in patterns if _is_pattern(pattern)]
    return frozenset(
        name for name in names - patterns if not any(fnmatchcase(name, each) for each in wild)
    )


def _is_pattern(name: str) -> bool:
    return any(character in name for character in "*?[")
