"""What the domain tells at one moment: nodes, ends of topics and services, ourselves left out.

Whoever is in the domain is a stranger: names that are none are counted and left out, and a domain
too large to be an app ends in a SourceError.
"""

from __future__ import annotations

import re
import time
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from rtron.errors import SourceError
from rtron.vocabulary import ROS2_ACTION_SERVICES
from rtron.wire.ros2.discovery_info import DiscoveryInfoReader
from rtron.wire.ros2.endpoints import (
    Ros2Endpoint,
    Ros2ServiceEndpoint,
    clients_of,
    gid_of,
    node_name,
    publishers_of,
    servers_of,
    service_endpoints_of_node,
    subscribers_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from rtron.wire.ros2.session import Ros2Session

MAX_NAMES = 20_000
"""Topics, services and nodes that an app may have, each."""
MAX_ENDPOINTS = 100_000
"""Ends of topics and services that it may have."""
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)
_ACTION_SERVICE_SUFFIXES = tuple(f"/_action/{end}" for end in ROS2_ACTION_SERVICES)
_T = TypeVar("_T", Ros2Endpoint, Ros2ServiceEndpoint)
_V = TypeVar("_V")


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot:
    """What the domain told: each node's full name as often as there is one, and all ends.

    `services` are the ends of services: all servers, and of actions the clients. `malformed` counts
    names that ROS 2 does not allow, and that are left out; `missing_endpoints` the ends that
    somebody says to have and the domain has not shown.
    """

    nodes: tuple[str, ...] = ()
    endpoints: tuple[Ros2Endpoint, ...] = ()
    services: tuple[Ros2ServiceEndpoint, ...] = ()
    malformed: int = 0
    missing_endpoints: int = 0

    @property
    def is_complete(self) -> bool:
        """Tell whether somebody is there, and all has been told of whoever is."""
        return bool(self.nodes) and self.all_named and not self.missing_endpoints

    @property
    def all_endpoints(self) -> tuple[Ros2Endpoint | Ros2ServiceEndpoint, ...]:
        """All ends."""
        return (*self.endpoints, *self.services)

    @property
    def all_named(self) -> bool:
        """Tell whether the domain has told the node of every end."""
        return all(endpoint.node for endpoint in self.all_endpoints)


class DomainReader:
    """Asks the domain through a node of ours, which is called `name`."""

    def __init__(self, session: Ros2Session, name: str) -> None:
        self._own_name = name
        self._node = session.node(name)
        self._participant = session.participant(name)
        self._claims = DiscoveryInfoReader(self._node)

    def close(self) -> None:
        """Ask no more."""
        self._claims.close()

    def fingerprint(self) -> object:
        """Return something cheap that changes with most changes of the graph."""
        with _DecodingErrors():
            nodes = self._node.get_node_names_and_namespaces()
            names = self._node.get_topic_names_and_types(no_demangle=True)
        return Counter(nodes), tuple(map(str, names))

    def snapshot(self, timeout: float) -> Snapshot:
        """Return all that the domain tells now; SourceError if that is too much.

        `timeout` is in seconds.
        """
        with _DecodingErrors():
            nodes = self._nodes()
            topics = _names(self._node.get_topic_names_and_types(), "topics")
            services = _names(self._node.get_service_names_and_types(), "services")
            deadline = time.monotonic() + timeout
            endpoints = self._query_each(
                self._topic_endpoints, filter(_NAME.fullmatch, topics), deadline
            )
            valid_services = filter(_NAME.fullmatch, services)
            service_endpoints = self._query_each(self._service_endpoints, valid_services, deadline)
            announced_gids = set(self._query_each(self._gids_of_topic, self._raw_names(), deadline))
        unresolved_services = set(services) - {endpoint.service for endpoint in service_endpoints}
        service_endpoints = (
            self._without_own(
                (*service_endpoints, *self._service_endpoints_by_node(nodes, unresolved_services))
            )
            if unresolved_services
            else service_endpoints
        )
        return Snapshot(
            nodes=tuple(sorted(node_name(*node) for node in nodes)),
            endpoints=_sorted_endpoints(self._without_own(endpoints)),
            services=_sorted_endpoints(
                endpoint
                for endpoint in self._without_own(service_endpoints)
                if endpoint.is_server or _is_action_service(endpoint.service)
            ),
            malformed=sum(not _NAME.fullmatch(name) for name in (*topics, *services)),
            missing_endpoints=len(self._claims.gids() - announced_gids),
        )

    def _nodes(self) -> list[tuple[str, str]]:
        """Return the other nodes; of those with our own name, one is us."""
        nodes = [(node[0], node[1]) for node in self._node.get_node_names_and_namespaces()]
        own_node = next((node for node in nodes if node_name(*node) == self._own_name), None)
        if own_node:
            nodes.remove(own_node)
        return _check_count(nodes, MAX_NAMES, "nodes")

    def _topic_endpoints(self, topic: str) -> list[Ros2Endpoint]:
        return [*publishers_of(self._node, topic), *subscribers_of(self._node, topic)]

    def _service_endpoints(self, service: str) -> list[Ros2ServiceEndpoint]:
        servers = servers_of(self._node, service)
        include_clients = not servers or _is_action_service(service)
        return [*servers, *clients_of(self._node, service)] if include_clients else servers

    def _raw_names(self) -> list[str]:
        """Return the topics by their names in DDS, in which services are topics too."""
        return _names(self._node.get_topic_names_and_types(no_demangle=True), "topics of DDS")

    def _gids_of_topic(self, raw: str) -> list[bytes]:
        publishers = self._node.get_publishers_info_by_topic(raw, no_mangle=True)
        subscribers = self._node.get_subscriptions_info_by_topic(raw, no_mangle=True)
        return [gid_of(info) for info in (*publishers, *subscribers)]

    def _service_endpoints_by_node(
        self, nodes: Iterable[tuple[str, str]], services: set[str]
    ) -> Iterator[Ros2ServiceEndpoint]:
        """Yield the ends of services that only the nodes' names lead to: the RMW is no DDS."""
        for base, namespace in dict.fromkeys(nodes):
            try:
                endpoints = service_endpoints_of_node(self._node, base, namespace)
            except (RuntimeError, ValueError):
                continue
            yield from (endpoint for endpoint in endpoints if endpoint.service in services)

    def _query_each(
        self, query: Callable[[str], Sequence[_V]], names: Iterable[str], deadline: float
    ) -> list[_V]:
        results: list[_V] = []
        for name in names:
            results += query(name)
            _check_count(results, MAX_ENDPOINTS, "endpoints")
            if time.monotonic() > deadline:
                raise SourceError("the domain tells more than there is time for", help=_DOMAIN_HELP)
        return results

    def _without_own(self, endpoints: Iterable[_T]) -> list[_T]:
        return [endpoint for endpoint in endpoints if not self._is_own(endpoint)]

    def _is_own(self, endpoint: Ros2Endpoint | Ros2ServiceEndpoint) -> bool:
        if not endpoint.gid:
            return endpoint.node == self._own_name
        return endpoint.participant == self._participant


class _DecodingErrors:
    """Makes a SourceError of names that are no UTF-8: rclpy then tells nothing of what is there."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, _type: object, error: BaseException | None, _traceback: object) -> None:
        if isinstance(error, UnicodeError):
            message = "somebody in the domain uses names that are no text"
            raise SourceError(message, help=_DOMAIN_HELP) from error


_DOMAIN_HELP = "is this the app's domain (--domain)? somebody there may want to be in the way"


def _names(named_types: Iterable[tuple[str, list[str]]], what: str) -> list[str]:
    return _check_count([name for name, _ in named_types], MAX_NAMES, what)


_U = TypeVar("_U")


def _check_count(items: list[_U], limit: int, what: str) -> list[_U]:
    if len(items) > limit:
        raise SourceError(f"the domain has more than {limit} {what}", help=_DOMAIN_HELP)
    return items


def _is_action_service(service: str) -> bool:
    """Tell whether a service is one of an action's, whose clients count."""
    return service.endswith(_ACTION_SERVICE_SUFFIXES)


def _sorted_endpoints(endpoints: Iterable[_T]) -> tuple[_T, ...]:
    return tuple(sorted(endpoints, key=lambda end: (end.node, str(end))))
