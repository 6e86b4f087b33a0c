"""The InteractionGraph of the app that runs in a ROS 2 domain, from rclpy's graph API.

We join the domain as a participant of our own, with one hidden node, and leave it again. What is
there are strangers: see `domain`. There is no master who knows all: see `settling`.
"""

from __future__ import annotations

import os
import uuid
from contextlib import closing
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import rclpy

from rtron.errors import InputError, SourceError
from rtron.sources.live.ros2.actions import actions_among, others
from rtron.sources.live.ros2.ambiguities import (
    action_types,
    doubles,
    strangers,
    topic_types,
    unnamed,
)
from rtron.sources.live.ros2.discovery import settled
from rtron.sources.live.ros2.domain import Domain, Snapshot
from rtron.sources.live.ros2.implied import implied_service, implied_topic
from rtron.vocabulary import (
    Endpoint,
    InteractionGraph,
    Node,
    Resolution,
    Service,
    Topic,
    Unresolved,
)
from rtron.wire.ros2.endpoints import Ros2Endpoint
from rtron.wire.ros2.session import Session

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.wire.ros2.service_endpoints import Ros2ServiceEnd

_T = TypeVar("_T", Ros2Endpoint, "Ros2ServiceEnd")


@dataclass(frozen=True, slots=True)
class Ros2Live:
    """A Source that reads the graph of a domain, None for that of the environment.

    It takes at most `timeout` (s), and as much as joining takes; less if the graph settles before.
    """

    domain: int | None
    timeout: float

    @property
    def surroundings(self) -> str:
        """What is read: the domain, and what the environment says of how it is joined."""
        domain = os.environ.get("ROS_DOMAIN_ID") or 0 if self.domain is None else self.domain
        rmw = rclpy.get_rmw_implementation_identifier()
        return f"ROS 2 domain {domain} ({', '.join((rmw, *_range()))})"

    def read(self) -> InteractionGraph:
        """Return the graph of the app that is running; SourceError if there is none to be seen."""
        name = f"/_rtron_scan_{uuid.uuid4().hex[:12]}"
        with closing(_joined(self.domain)) as session, closing(Domain(session, name)) as domain:
            found = settled(domain, self.timeout)
            if not found.seen.nodes and not found.seen.endpoints:
                raise _nobody(session.domain, self.timeout)
        restless = () if found.still else (_restless(self.timeout),)
        return graph_of(found.seen, restless)


def graph_of(seen: Snapshot, doubts: tuple[Unresolved, ...] = ()) -> InteractionGraph:
    """Return the graph of what the domain told; `doubts` are told besides its own."""
    told = replace(seen, endpoints=_named(seen.endpoints), services=_named(seen.services))
    actions = actions_among(told)
    ends = others(told.endpoints, actions)
    services = others(told.services, actions)
    return InteractionGraph(
        app="live app",
        ros=2,
        nodes=_nodes(told),
        topics=tuple(_topics(ends)),
        endpoints=tuple(map(_endpoint, ends)),
        services=tuple(dict.fromkeys(_service(end) for end in services if end.serves)),
        actions=actions,
        unresolved=(
            *doubts,
            *_malformed(seen),
            *_owed(seen),
            *strangers(seen),
            *doubles(seen),
            *topic_types(ends),
            *action_types(actions),
        ),
    )


def _range() -> Iterator[str]:
    """Yield how far discovery reaches, if the environment says it."""
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":
        yield "this machine only"
    elif told := os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE"):
        yield {"LOCALHOST": "this machine only"}.get(told, f"discovery range {told}")


def _joined(domain: int | None) -> Session:
    try:
        return Session(domain)
    except InputError:
        raise
    except RuntimeError as error:
        raise SourceError(f"ROS 2 cannot be joined: {error}", help=_ENVIRONMENT) from error


_ENVIRONMENT = "look at ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE and RMW_IMPLEMENTATION"


def _nobody(domain: int, timeout: float) -> SourceError:
    message = f"no node is seen in ROS 2 domain {domain} within {timeout:g} s"
    help = f"is the app running, with the same environment? {_ENVIRONMENT}, or give --domain"
    return SourceError(message, help=help)


def _restless(timeout: float) -> Unresolved:
    why = f"was still changing after {timeout:g} s: there may be more"
    return Unresolved(what="the graph", why=why)


def _malformed(seen: Snapshot) -> Iterator[Unresolved]:
    if seen.malformed:
        why = f"has {seen.malformed} names of topics and services that ROS 2 does not allow"
        yield Unresolved(what="the domain", why=f"{why}, which are left out")


def _owed(seen: Snapshot) -> Iterator[Unresolved]:
    if seen.owed:
        why = f"has nodes that are said to have {seen.owed} more endpoints, which nobody shows"
        yield Unresolved(what="the domain", why=why)


def _named(ends: tuple[_T, ...]) -> tuple[_T, ...]:
    """Return the ends, those without a node's name with a name for their participant."""
    return tuple(end if end.node else replace(end, node=unnamed(end.participant)) for end in ends)


def _nodes(told: Snapshot) -> tuple[Node, ...]:
    speaking = (end.node for end in told.ends)
    return tuple(Node(name=name) for name in sorted({*told.nodes, *speaking} - {""}))


def _topics(ends: Iterable[Ros2Endpoint]) -> Iterator[Topic]:
    types: dict[str, set[str]] = {}
    for end in ends:
        types.setdefault(end.topic, set()).add(end.type)
    for name, used in sorted(types.items()):
        yield Topic(name=name, types=tuple(sorted(used)))


def _endpoint(end: Ros2Endpoint) -> Endpoint:
    return Endpoint(
        node=end.node,
        topic=end.topic,
        direction=end.direction,
        type=end.type,
        implicit=implied_topic(end.topic, end.direction),
        resolution=Resolution.OBSERVED,
        qos=end.qos,
        gid=end.gid.hex(),
    )


def _service(end: Ros2ServiceEnd) -> Service:
    implicit = implied_service(end.node, end.service, end.type)
    return Service(node=end.node, name=end.service, type=end.type, implicit=implicit)
