"""Who may do what in an app: rights on names, by node, by process.

The words are those of SROS2's policies (sros2, policy.xsd): a topic is published and subscribed, a
service replied and requested, an action executed and called.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.vocabulary import StringEnum


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
