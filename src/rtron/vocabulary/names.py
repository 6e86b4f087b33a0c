"""How names are spelled: message types of both ROS generations, and the guard's private topics."""

from fnmatch import fnmatchcase

PRIVATE_ROOT = "/rtron"
GUARD_NODE = "/rtron_guard"
SUPERVISOR_NODE = "/rtron_supervisor"


def normalise_type(message_type: str) -> str:
    """Return a message type in ROS 1 spelling: `pkg/msg/Name` and `pkg/Name` are one type."""
    return message_type.replace("/msg/", "/", 1)


def unstamped_type(message_type: str) -> str:
    """Return the type that a stamped velocity counts as: `TwistStamped` counts with `Twist`."""
    twist = "geometry_msgs/Twist"
    return twist if normalise_type(message_type) == twist + "Stamped" else message_type


def flow_topic(topic: str, flow: str) -> str:
    """Return the private topic that a flow's publisher is remapped to."""
    return f"{PRIVATE_ROOT}{topic}/{flow}"


def output_topic(topic: str) -> str:
    """Return the private topic that the successors are remapped to."""
    return f"{PRIVATE_ROOT}{topic}/out"


def matches_node(pattern: str, node: str) -> bool:
    """Tell whether a plan's publisher, a node name or a pattern with `*`, means `node`."""
    return pattern == node or fnmatchcase(node, pattern)
