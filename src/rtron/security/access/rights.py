"""Who may do what in an app: rights on names, by node, by process.

The words are those of SROS2's policies (sros2, policy.xsd): a topic is published and subscribed, a
service replied and requested, an action executed and called.

See rclcpp: ParameterService, TimeSource, NodeTypeDescriptions; rclpy: Node.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from rtron.vocabulary import (
    BULK_NODE,
    GUARD_NODE,
    PRIVATE_ROOT,
    SUPERVISOR_NODE,
    VERIFY_NODE,
    StringEnum,
    is_guard_name,
    matches_node,
)


class RightKind(StringEnum):
    """What a node does with a name."""

    PUBLISH = "publish"
    SUBSCRIBE = "subscribe"
    REPLY = "reply"
    REQUEST = "request"
    EXECUTE = "execute"
    CALL = "call"


@dataclass(frozen=True, slots=True, order=True)
class AccessRight:
    """One thing that is allowed: all else is not.

    `name` is the full ROS name of a topic, a service or an action, after the plan's remaps. A `*`
    in it stands for any characters, slashes included; only names that RTron makes have one.
    """

    kind: RightKind
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeAccess:
    """What one node may do; `node` is its full name, or a pattern with `*` if it varies.

    `rights` are all of them, `library` those among them that every node has (`node_rights`).
    """

    node: str
    rights: frozenset[AccessRight]
    library: frozenset[AccessRight] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessAccess:
    """A process: what it may do is what its nodes may do, since they share its keys and memory.

    `name` is that of the node after which the process is called, a container's for its components,
    without `*`. It is the name of its enclave.
    """

    name: str
    nodes: tuple[NodeAccess, ...]

    @property
    def rights(self) -> frozenset[AccessRight]:
        """All that a node of the process may do."""
        return frozenset().union(*(node.rights for node in self.nodes))

    @property
    def own_rights(self) -> tuple[AccessRight, ...]:
        """What its nodes may do beside what every node may, in order."""
        own = frozenset().union(*(node.rights - node.library for node in self.nodes))
        return tuple(sorted(own))

    def names(self, kind: RightKind) -> tuple[str, ...]:
        """Return the names on which the process has a right, in order."""
        return tuple(sorted(right.name for right in self.rights if right.kind is kind))


@dataclass(frozen=True, slots=True, kw_only=True)
class AccessDoubt:
    """Something that is not allowed, or not known, and may be missed when the app runs."""

    node: str
    what: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AppAccess:
    """The processes of a guarded app, the guard's own first, and what may break."""

    processes: tuple[ProcessAccess, ...]
    doubts: tuple[AccessDoubt, ...] = ()

    def __iter__(self) -> Iterator[ProcessAccess]:
        return iter(self.processes)


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
