"""Which names can stand in a permission: what strangers chose must not widen one.

See rclcpp: ParameterService, TimeSource, NodeTypeDescriptions; rclpy: Node.
"""

import re
from collections.abc import Iterator

from rtron.security.access.rights import AccessRight, RightKind
from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    VERIFY_NODE,
    is_guard_name,
    matches_node,
)

_TOKEN = r"/[A-Za-z_][A-Za-z0-9_]*"  # noqa: S105 - a part of a name
_NAME = re.compile(f"(?:{_TOKEN})+", re.ASCII)
_PATTERN = re.compile(rf"(?:{_TOKEN})*{_TOKEN}\*[A-Za-z0-9_]*", re.ASCII)
_LONGEST = 255
LONGEST_PROCESS_NAME = 64
"""A certificate holds no longer one (RFC 5280, ub-common-name)."""
_OWN_NODES = frozenset({GUARD_NODE, BULK_NODE, SUPERVISOR_NODE, VERIFY_NODE})
_TOOLS = re.compile(
    r"(?:/[^/]+)*/(?:_[^/]*|launch_ros_[0-9]+|rosbag2_(?:recorder|player))", re.ASCII
)


def is_legal_name(name: str) -> bool:
    """Tell whether a name is a full one of ROS 2, so that it means itself in every expression.

    See design.ros2.org: Topic and Service name mapping to DDS.
    """
    return len(name) <= _LONGEST and _NAME.fullmatch(name) is not None


def is_legal_node(name: str) -> bool:
    """Tell whether a node's name is a full one, or a pattern whose last part begins as it does."""
    return is_legal_name(name) or (len(name) <= _LONGEST and _PATTERN.fullmatch(name) is not None)


def is_own_node(name: str) -> bool:
    """Tell whether a node is one of RTron's."""
    return name == VERIFY_NODE or is_guard_name(name)


def means_own_node(pattern: str) -> bool:
    """Tell whether a pattern means one of RTron's nodes, or what lies below a node of it."""
    return any(matches_node(pattern, node) for node in (*_OWN_NODES, f"{PRIVATE_ROOT}/"))


def is_tool(name: str) -> bool:
    """Tell whether a node belongs to a command line: hidden, launch's own, a recorder's."""
    return _TOOLS.fullmatch(name) is not None


def process_name(node: str) -> str:
    """Return a name for the process of a node, which has no `*` in it."""
    return node.replace("*", "any")


PARAMETER_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
)
_SERVICES = (*PARAMETER_SERVICES, "get_type_description")


def node_rights(node: str) -> Iterator[AccessRight]:
    """Yield what the client library does for a node, a full name or a pattern.

    The services are the node's own: to offer them lets nobody call them.
    """
    yield AccessRight(RightKind.PUBLISH, "/rosout")
    yield AccessRight(RightKind.PUBLISH, "/parameter_events")
    yield AccessRight(RightKind.SUBSCRIBE, "/parameter_events")
    yield AccessRight(RightKind.SUBSCRIBE, "/clock")
    for service in _SERVICES:
        yield AccessRight(RightKind.REPLY, f"{node}/{service}")
