"""The InteractionGraph of the app that runs in a ROS 2 domain, from rclpy's graph API.

We join the domain as a participant of our own, with one hidden node, and leave it again. The
participants there are untrusted: see `domain`. No master knows the whole graph.

DDS does not announce the end of discovery. What was missed comes again with the next announcement
or heartbeat, which Fast DDS sends every 3 s: a graph may be stable for that long and incomplete (of
30 joins of an app of 20 processes on a busy machine, 13 were complete only after 2.5 to 4.4 s). So
no snapshot is taken before, and each participant must have all endpoints that it announces. Beside
that, polls in time count and not seconds: a machine too busy to receive changes takes longer.
"""

from __future__ import annotations

import os
import time
import uuid
from contextlib import closing
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import rclpy

from rtron.errors import SourceError
from rtron.sources.live.ros2.actions import find_actions, outside_of_actions
from rtron.sources.live.ros2.ambiguities import (
    action_type_conflicts,
    duplicate_nodes,
    participant_placeholder,
    topic_type_conflicts,
    unnamed_participants,
)
from rtron.sources.live.ros2.domain import DomainReader, Snapshot
from rtron.vocabulary import (
    VERIFY_NODE,
    Direction,
    Endpoint,
    InteractionGraph,
    Node,
    Resolution,
    Service,
    Topic,
    UnresolvedItem,
)
from rtron.wire.ros2.endpoints import Ros2Endpoint
from rtron.wire.ros2.session import Ros2Session

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.wire.ros2.endpoints import Ros2ServiceEndpoint

_IMPLICIT_TOPICS = frozenset({"/rosout", "/parameter_events"})
_CLOCK = "/clock"
_PARAMETER_SERVICE_PACKAGES = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")


def is_hidden(name: str) -> bool:
    """Tell whether a part of the name begins with `_` (ROS 2 design: Topic and Service Names)."""
    return "/_" in name


def is_implicit_topic(topic: str, direction: Direction) -> bool:
    """Tell whether an end of a topic is the client library's, or hidden."""
    is_clock = topic == _CLOCK and direction is Direction.SUBSCRIBE
    return is_clock or topic in _IMPLICIT_TOPICS or is_hidden(topic)


def is_implicit_service(node: str, service: str, type: str) -> bool:
    """Tell whether a service is the client library's, like those of parameters, or hidden."""
    is_parameter_service = service.startswith(f"{node}/") and type.startswith(
        _PARAMETER_SERVICE_PACKAGES
    )
    return is_parameter_service or is_hidden(service)


_T = TypeVar("_T", Ros2Endpoint, "Ros2ServiceEndpoint")


@dataclass(frozen=True, slots=True)
class Ros2LiveSource:
    """A Source that reads the graph of a domain, None for that of the environment.

    It takes at most `timeout` (s), and as much as joining takes; less if the graph settles before.
    """

    domain: int | None
    timeout: float

    @property
    def domain_description(self) -> str:
        """What is read: the domain, and what the environment says of how it is joined."""
        domain = os.environ.get("ROS_DOMAIN_ID") or 0 if self.domain is None else self.domain
        rmw = rclpy.get_rmw_implementation_identifier()
        return f"ROS 2 domain {domain} ({', '.join((rmw, *_discovery_range()))})"

    def read(self) -> InteractionGraph:
        """Return the graph of the app that is running; SourceError if there is none to be seen."""
        name = f"/_rtron_scan_{uuid.uuid4().hex[:12]}"
        session = Ros2Session(self.domain, VERIFY_NODE)
        with closing(session), closing(DomainReader(session, name)) as domain:
            discovered = discover_graph(domain, self.timeout)
            if not discovered.snapshot.nodes and not discovered.snapshot.endpoints:
                raise _empty_domain_error(session.domain, self.timeout)
        notes = () if discovered.is_stable else (_unstable_graph(self.timeout),)
        return graph_of_snapshot(discovered.snapshot, notes)


def graph_of_snapshot(
    snapshot: Snapshot, notes: tuple[UnresolvedItem, ...] = ()
) -> InteractionGraph:
    """Return the graph of what the domain told; `notes` are told besides its own."""
    named_snapshot = replace(
        snapshot,
        endpoints=_with_placeholder_names(snapshot.endpoints),
        services=_with_placeholder_names(snapshot.services),
    )
    actions = find_actions(named_snapshot)
    endpoints = outside_of_actions(named_snapshot.endpoints, actions)
    services = outside_of_actions(named_snapshot.services, actions)
    return InteractionGraph(
        app="live app",
        ros=2,
        nodes=_nodes(named_snapshot),
        topics=tuple(_topics(endpoints)),
        endpoints=tuple(map(_endpoint, endpoints)),
        services=tuple(
            dict.fromkeys(_service(endpoint) for endpoint in services if endpoint.is_server)
        ),
        actions=actions,
        unresolved=(
            *notes,
            *_malformed_names(snapshot),
            *_missing_endpoints(snapshot),
            *unnamed_participants(snapshot),
            *duplicate_nodes(snapshot),
            *topic_type_conflicts(endpoints),
            *action_type_conflicts(actions),
        ),
    )


def _discovery_range() -> Iterator[str]:
    """Yield how far discovery reaches, if the environment says it."""
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":
        yield "this machine only"
    elif discovery_range := os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE"):
        yield {"LOCALHOST": "this machine only"}.get(
            discovery_range, f"discovery range {discovery_range}"
        )


_ENVIRONMENT_HELP = "look at ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE and RMW_IMPLEMENTATION"


def _empty_domain_error(domain: int, timeout: float) -> SourceError:
    message = f"no node is seen in ROS 2 domain {domain} within {timeout:g} s"
    help = f"is the app running, with the same environment? {_ENVIRONMENT_HELP}, or give --domain"
    return SourceError(message, help=help)


def _unstable_graph(timeout: float) -> UnresolvedItem:
    why = f"was still changing after {timeout:g} s: there may be more"
    return UnresolvedItem(what="the graph", why=why)


def _malformed_names(snapshot: Snapshot) -> Iterator[UnresolvedItem]:
    if snapshot.malformed:
        why = f"has {snapshot.malformed} names of topics and services that ROS 2 does not allow"
        yield UnresolvedItem(what="the domain", why=f"{why}, which are left out")


def _missing_endpoints(snapshot: Snapshot) -> Iterator[UnresolvedItem]:
    if snapshot.missing_endpoints:
        missing = f"{snapshot.missing_endpoints} more endpoints, which nobody shows"
        why = f"has nodes that are said to have {missing}"
        yield UnresolvedItem(what="the domain", why=why)


def _with_placeholder_names(endpoints: tuple[_T, ...]) -> tuple[_T, ...]:
    """Return the ends, those without a node's name with a name for their participant."""
    return tuple(
        endpoint
        if endpoint.node
        else replace(endpoint, node=participant_placeholder(endpoint.participant))
        for endpoint in endpoints
    )


def _nodes(snapshot: Snapshot) -> tuple[Node, ...]:
    endpoint_nodes = (endpoint.node for endpoint in snapshot.all_endpoints)
    return tuple(Node(name=name) for name in sorted({*snapshot.nodes, *endpoint_nodes} - {""}))


def _topics(endpoints: Iterable[Ros2Endpoint]) -> Iterator[Topic]:
    types: dict[str, set[str]] = {}
    for endpoint in endpoints:
        types.setdefault(endpoint.topic, set()).add(endpoint.type)
    for name, used in sorted(types.items()):
        yield Topic(name=name, types=tuple(sorted(used)))


def _endpoint(endpoint: Ros2Endpoint) -> Endpoint:
    return Endpoint(
        node=endpoint.node,
        topic=endpoint.topic,
        direction=endpoint.direction,
        type=endpoint.type,
        implicit=is_implicit_topic(endpoint.topic, endpoint.direction),
        resolution=Resolution.OBSERVED,
        qos=endpoint.qos,
        gid=endpoint.gid.hex(),
    )


def _service(endpoint: Ros2ServiceEndpoint) -> Service:
    implicit = is_implicit_service(endpoint.node, endpoint.service, endpoint.type)
    return Service(node=endpoint.node, name=endpoint.service, type=endpoint.type, implicit=implicit)


MIN_DISCOVERY_S = 3.5
"""How long after joining a graph counts as complete at the earliest."""
_POLL_S = 0.05
_LATE_POLL_S = 0.15
"""A poll so much later than meant does not count: other processes are as late."""
_STABLE_POLLS = 10
"""Equal fingerprints before the first snapshot: 0.5 s at least."""
_PROMPT_DISCOVERY_S = 4.5
"""What is discovered later than this took two announcements; another may take three."""
_ANNOUNCEMENT_POLLS = 64
"""Equal fingerprints that are then needed: 3.2 s at least, a whole period of announcements."""
_STABLE_POLLS_BETWEEN_SNAPSHOTS = 5
"""Equal fingerprints before each further snapshot."""
_SNAPSHOT_TIMEOUT_S = 10.0
"""The longest that one snapshot may take."""


@dataclass(frozen=True, slots=True)
class DiscoveredGraph:
    """The graph as it was in the end, and whether it was stable then."""

    snapshot: Snapshot
    is_stable: bool


def discover_graph(domain: DomainReader, timeout: float) -> DiscoveredGraph:
    """Return the graph of a domain when it has settled, or what there is after `timeout` (s)."""
    start = time.monotonic()
    deadline = start + timeout
    last_change = _wait_until_stable(
        domain, _STABLE_POLLS, min(start + MIN_DISCOVERY_S, deadline), deadline
    )
    if last_change > start + _PROMPT_DISCOVERY_S:
        _wait_until_stable(domain, _ANNOUNCEMENT_POLLS, 0.0, deadline)
    snapshot = domain.snapshot(_SNAPSHOT_TIMEOUT_S)
    while True:
        _wait_until_stable(domain, _STABLE_POLLS_BETWEEN_SNAPSHOTS, 0.0, deadline)
        previous, snapshot = snapshot, domain.snapshot(_SNAPSHOT_TIMEOUT_S)
        is_stable = snapshot == previous
        if (is_stable and snapshot.is_complete) or time.monotonic() >= deadline:
            return DiscoveredGraph(snapshot, is_stable)


def _wait_until_stable(domain: DomainReader, polls: int, earliest: float, deadline: float) -> float:
    """Return when the fingerprint changed last, once it was equal `polls` times; 0 for never.

    Return not before the time is `earliest`, and at once when it is `deadline`.
    """
    fingerprint, equal_polls, last_change = domain.fingerprint(), 0, 0.0
    while (equal_polls < polls or time.monotonic() < earliest) and time.monotonic() < deadline:
        polled_at = time.monotonic()
        time.sleep(_POLL_S)
        current = domain.fingerprint()
        if current != fingerprint:
            fingerprint, equal_polls, last_change = current, 0, time.monotonic()
        elif time.monotonic() - polled_at <= _LATE_POLL_S:
            equal_polls += 1
    return last_change
