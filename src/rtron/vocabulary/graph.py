"""The InteractionGraph: who publishes what to whom in an app (paper section 2.1)."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from rtron.vocabulary.enums import (
    ActionRole,
    Direction,
    Domain,
    Durability,
    FunctionType,
    HiddenPart,
    Liveliness,
    Reliability,
    Resolution,
    Trust,
    UnresolvedCause,
)
from rtron.vocabulary.evidence import Evidence
from rtron.vocabulary.wiring import WiringFact

GRAPH_SCHEMA = "rtron.graph/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class QoS:
    """The quality of service an endpoint asks for or offers (ROS 2: About-Quality-of-Service).

    `depth` counts messages, 0 where it is not known: ROS 2's graph does not tell it. `deadline`,
    `lifespan` and `lease` (of the liveliness) are ns, 0 for ever.
    """

    reliability: Reliability = Reliability.RELIABLE
    durability: Durability = Durability.VOLATILE
    depth: int = 0
    deadline: int = 0
    lifespan: int = 0
    liveliness: Liveliness = Liveliness.AUTOMATIC
    lease: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Node:
    """A ROS node: its full name, and where it comes from as far as that is known.

    `unread` marks one whose endpoints are not known, or not all: it has neither source nor model,
    or firmware behind it names them. `process` is the node in whose process it runs: a component's
    container; empty for its own.
    """

    name: str
    package: str = ""
    executable: str = ""
    origin: str = ""
    trust: Trust = Trust.UNKNOWN
    function: FunctionType | None = None
    domain: Domain | None = None
    unread: bool = False
    process: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """A topic and the message types its endpoints use; more than one type is a fault of the app."""

    name: str
    types: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Endpoint:
    """One node publishing or subscribing one topic.

    `declared_name` is the name before remapping; `implicit` marks what the client library adds
    by itself (`/rosout`, `/clock`). `gid` is the endpoint's own id in ROS 2, as hex digits.
    """

    node: str
    topic: str
    direction: Direction
    type: str = ""
    declared_name: str = ""
    implicit: bool = False
    resolution: Resolution = Resolution.LITERAL
    qos: QoS | None = None
    gid: str = ""
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service that a node offers; `implicit` marks those of the client library, or hidden."""

    node: str
    name: str
    type: str = ""
    implicit: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceClient:
    """A service that a node calls; `implicit` marks those of the client library."""

    node: str
    name: str
    type: str = ""
    implicit: bool = False


NodeParameterValue: TypeAlias = bool | int | float | str | tuple[bool | int | float | str, ...]
"""What a parameter of ROS 2 may hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeParameter:
    """A parameter that a node has, and what it is at the start; None if not known.

    `read_once` says that its node is seen to read it at the start alone: to set it changes nothing.
    """

    node: str
    name: str
    value: NodeParameterValue | None = None
    read_once: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """A node's side of an action, the whole action as one unit; `name` is its namespace."""

    node: str
    name: str
    type: str = ""
    role: ActionRole


@dataclass(frozen=True, slots=True, kw_only=True)
class UnresolvedItem:
    """Something that could not be read, and why: never silently left out.

    `missing` is what was looked for and is not there: a file, or PACKAGE/PROGRAM; `nearest` says
    what may be meant instead, for people. `hides` is what of the app may be behind it, `package`
    the one whose files would tell. Without a `cause` it is code that is not followed.
    """

    what: str
    why: str
    missing: str = ""
    nearest: str = ""
    package: str = ""
    hides: HiddenPart | None = None
    cause: UnresolvedCause | None = None
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, kw_only=True)
class InteractionGraph:
    """Nodes, topics and endpoints of an app, with its services, actions and what stayed unresolved.

    `ros` is the generation, 1 or 2. Clients of services, and parameters of ROS 2, are those that
    source or a model tells of; parameters of ROS 1 those that a launch sets. `wiring` is what a
    scan sees beside them. Indexes by topic and by node are built on first use, in one pass over
    the endpoints.
    """

    app: str
    ros: int = 1
    nodes: tuple[Node, ...] = ()
    topics: tuple[Topic, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()
    services: tuple[Service, ...] = ()
    actions: tuple[Action, ...] = ()
    clients: tuple[ServiceClient, ...] = ()
    parameters: tuple[NodeParameter, ...] = ()
    unresolved: tuple[UnresolvedItem, ...] = ()
    wiring: tuple[WiringFact, ...] = ()
    _indexes: dict[str, Mapping[str, tuple[Endpoint, ...]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def publishers(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the endpoints that publish `topic`."""
        return self._index("publishers", Direction.PUBLISH, _topic_of).get(topic, ())

    def subscribers(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the endpoints that subscribe `topic`."""
        return self._index("subscribers", Direction.SUBSCRIBE, _topic_of).get(topic, ())

    def published_by(self, node: str) -> tuple[Endpoint, ...]:
        """Return what `node` publishes."""
        return self._index("published_by", Direction.PUBLISH, _node_of).get(node, ())

    def subscribed_by(self, node: str) -> tuple[Endpoint, ...]:
        """Return what `node` subscribes."""
        return self._index("subscribed_by", Direction.SUBSCRIBE, _node_of).get(node, ())

    def _index(
        self, name: str, direction: Direction, key: Callable[[Endpoint], str]
    ) -> Mapping[str, tuple[Endpoint, ...]]:
        if name not in self._indexes:
            matching = (e for e in self.endpoints if e.direction is direction)
            self._indexes[name] = _grouped(matching, key)
        return self._indexes[name]


def _topic_of(endpoint: Endpoint) -> str:
    return endpoint.topic


def _node_of(endpoint: Endpoint) -> str:
    return endpoint.node


def _grouped(
    endpoints: Iterable[Endpoint], key: Callable[[Endpoint], str]
) -> Mapping[str, tuple[Endpoint, ...]]:
    groups: dict[str, list[Endpoint]] = defaultdict(list)
    for endpoint in endpoints:
        groups[key(endpoint)].append(endpoint)
    return {name: tuple(group) for name, group in groups.items()}
