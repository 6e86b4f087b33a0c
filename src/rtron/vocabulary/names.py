"""How names are spelled: message types of both ROS generations, and the guard's private topics."""

import re
from collections.abc import Iterable
from fnmatch import fnmatchcase

PRIVATE_ROOT = "/rtron"
GUARD_NODE = "/rtron_guard"
BULK_NODE = "/rtron_bulk"
SUPERVISOR_NODE = "/rtron_supervisor"
VERIFY_NODE = "/rtron_verify"
BRIDGE_ROOT = "/bridge"
"""The namespace of the nodes of a bridge's clients."""
CELL_ROOT = f"{PRIVATE_ROOT}/cell"
GATEWAY_NODE = f"{CELL_ROOT}/gateway"
"""Who publishes and calls in a cell what comes from outside."""
STOPPER_NODE = f"{CELL_ROOT}/stopper"
"""Who stops the robot in a cell when the guard is gone."""
_WORD_START = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
EMERGENCY_STOP = re.compile(
    r"(?:^|[/_])(?:e_?stop|emergency|run_?stop"
    r"|(?:stop_(?:all|button|robot)|kill(?:_?switch)?|halt|freeze|(?:base|drive|force|hardware"
    r"|protective|remote|safe|safety|software|vehicle|wireless)_stop)(?![a-z]))"
)
"""What says in the name of a topic, a service or a node that it stops a robot (`snake_case`)."""
TRANSFORMS = "/tf"
"""The topic of transforms, before remaps; who remaps it remaps /tf_static too."""
TRANSFORM_TOPICS = (TRANSFORMS, "/tf_static")


def normalise_type(message_type: str) -> str:
    """Return a message type in ROS 1 spelling: `pkg/msg/Name` and `pkg/Name` are one type."""
    return message_type.replace("/msg/", "/", 1)


def unstamped_type(message_type: str) -> str:
    """Return the type that a stamped velocity counts as: `TwistStamped` counts with `Twist`."""
    twist = "geometry_msgs/Twist"
    return twist if normalise_type(message_type) == twist + "Stamped" else message_type


def is_bridge_client(node: str) -> bool:
    """Tell whether a node is that of a bridge's client, which no scan and no launch file has."""
    return node.startswith(f"{BRIDGE_ROOT}/")


def is_guard_name(node: str) -> bool:
    """Tell whether a node name is one that only the guard goes by."""
    return node in (GUARD_NODE, BULK_NODE, SUPERVISOR_NODE) or is_private_name(node)


def is_private_name(name: str) -> bool:
    """Tell whether a name lies where all names are the guard's to give."""
    return name == PRIVATE_ROOT or name.startswith(PRIVATE_ROOT + "/")


def flow_topic(topic: str, flow: str) -> str:
    """Return the private topic that a flow's publisher is remapped to."""
    return f"{PRIVATE_ROOT}{topic}/{flow}"


def output_topic(topic: str) -> str:
    """Return the private topic that the successors are remapped to."""
    return f"{PRIVATE_ROOT}{topic}/out"


def lease_topic(lease: str, part: str) -> str:
    """Return a topic of a lease: `request`, `answer` or `status`."""
    return f"{PRIVATE_ROOT}/leases/{lease}/{part}"


def matches_node(pattern: str, node: str) -> bool:
    """Tell whether a plan's publisher, a node name or a pattern with `*`, means `node`."""
    return pattern == node or fnmatchcase(node, pattern)


def patterns_overlap(one: str, other: str) -> bool:
    """Tell whether one of two nodes or patterns means the other."""
    return matches_node(one, other) or matches_node(other, one)


def snake_case(name: str) -> str:
    """Return a name with its words apart: `chassisCommand` as `chassis_command`."""
    return _WORD_START.sub("_", name).lower()


def are_nested(namespace: str, other: str) -> bool:
    """Return whether one namespace is the other, or within it."""
    outer, inner = sorted((f"{namespace}/", f"{other}/"), key=len)
    return inner.startswith(outer)


def fits_open_name(name: str, open_names: Iterable[str]) -> bool:
    """Return whether a name may be one of those that are known in part: `{…}` is not known."""
    return any("{" in each and fnmatchcase(name, _as_pattern(each)) for each in open_names)


def _as_pattern(name: str) -> str:
    """Return a name with holes, `{…}`, as a pattern."""
    parts = name.split("{")
    return parts[0] + "".join("*" + part.partition("}")[2] for part in parts[1:])
