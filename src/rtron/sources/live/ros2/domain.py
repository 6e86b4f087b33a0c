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
from rtron.vocabulary import REQUESTED
from rtron.wire.ros2.discovery_info import Claims
from rtron.wire.ros2.endpoints import Ros2Endpoint, gid_of, node_name, publishers_of, subscribers_of
from rtron.wire.ros2.service_endpoints import Ros2ServiceEnd, clients_of, ends_by_node, servers_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from rtron.wire.ros2.session import Session

MOST_NAMES = 20_000
"""Topics, services and nodes that an app may have, each."""
MOST_ENDS = 100_000
"""Ends of topics and services that it may have."""
_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)
_ACTIONS = tuple(f"/_action/{end}" for end in REQUESTED)
_T = TypeVar("_T", Ros2Endpoint, Ros2ServiceEnd)
_V = TypeVar("_V")


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot:
    """What the domain told: each node's full name as often as there is one, and all ends.

    `services` are the ends of services: all servers, and of actions the clients. `malformed` counts
    names that ROS 2 does not allow, and that are left out; `owed` the ends that somebody says to
    have and the domain has not shown.
    """

    nodes: tuple[str, ...] = ()
    endpoints: tuple[Ros2Endpoint, ...] = ()
    services: tuple[Ros2ServiceEnd, ...] = ()
    malformed: int = 0
    owed: int = 0

    @property
    def whole(self) -> bool:
        """Tell whether somebody is there, and all has been told of whoever is."""
        return bool(self.nodes) and self.named and not self.owed

    @property
    def ends(self) -> tuple[Ros2Endpoint | Ros2ServiceEnd, ...]:
        """All ends."""
        return (*self.endpoints, *self.services)

    @property
    def named(self) -> bool:
        """Tell whether the domain has told the node of every end."""
        return all(end.node for end in self.ends)


class Domain:
    """Asks the domain through a node of ours, which is called `name`."""

    def __init__(self, session: Session, name: str) -> None:
        self._own_name = name
        self._node = session.node(name)
        self._participant = session.participant(name)
        self._claims = Claims(self._node)

    def close(self) -> None:
        """Ask no more."""
        self._claims.close()

    def sign(self) -> object:
        """Return something cheap that changes with most changes of the graph."""
        with _Texts():
            nodes = self._node.get_node_names_and_namespaces()
            names = self._node.get_topic_names_and_types(no_demangle=True)
        return Counter(nodes), tuple(map(str, names))

    def look(self, patience: float) -> Snapshot:
        """Return all that the domain tells now; SourceError if that is too much.

        `patience` is in seconds.
        """
        with _Texts():
            nodes = self._nodes()
            topics = _names(self._node.get_topic_names_and_types(), "topics")
            services = _names(self._node.get_service_names_and_types(), "services")
            until = time.monotonic() + patience
            endpoints = self._bounded(self._endpoints, filter(_NAME.fullmatch, topics), until)
            named = filter(_NAME.fullmatch, services)
            ends = self._bounded(self._ends_of_service, named, until)
            shown = set(self._bounded(self._gids, self._raw_names(), until))
        silent = set(services) - {end.service for end in ends}
        ends = self._others((*ends, *self._by_node(nodes, silent))) if silent else ends
        return Snapshot(
            nodes=tuple(sorted(node_name(*node) for node in nodes)),
            endpoints=_sorted(self._others(endpoints)),
            services=_sorted(end for end in self._others(ends) if end.serves or _asks(end.service)),
            malformed=sum(not _NAME.fullmatch(name) for name in (*topics, *services)),
            owed=len(self._claims.gids() - shown),
        )

    def _nodes(self) -> list[tuple[str, str]]:
        """Return the other nodes; of those with our own name, one is us."""
        nodes = [(node[0], node[1]) for node in self._node.get_node_names_and_namespaces()]
        own = next((node for node in nodes if node_name(*node) == self._own_name), None)
        if own:
            nodes.remove(own)
        return _few(nodes, MOST_NAMES, "nodes")

    def _endpoints(self, topic: str) -> list[Ros2Endpoint]:
        return [*publishers_of(self._node, topic), *subscribers_of(self._node, topic)]

    def _ends_of_service(self, service: str) -> list[Ros2ServiceEnd]:
        servers = servers_of(self._node, service)
        asked = not servers or _asks(service)
        return [*servers, *clients_of(self._node, service)] if asked else servers

    def _raw_names(self) -> list[str]:
        """Return the topics by their names in DDS, in which services are topics too."""
        return _names(self._node.get_topic_names_and_types(no_demangle=True), "topics of DDS")

    def _gids(self, raw: str) -> list[bytes]:
        publishers = self._node.get_publishers_info_by_topic(raw, no_mangle=True)
        subscribers = self._node.get_subscriptions_info_by_topic(raw, no_mangle=True)
        return [gid_of(info) for info in (*publishers, *subscribers)]

    def _by_node(
        self, nodes: Iterable[tuple[str, str]], services: set[str]
    ) -> Iterator[Ros2ServiceEnd]:
        """Yield the ends of services that only the nodes' names lead to: the RMW is no DDS."""
        for base, space in dict.fromkeys(nodes):
            try:
                ends = ends_by_node(self._node, base, space)
            except (RuntimeError, ValueError):
                continue
            yield from (end for end in ends if end.service in services)

    def _bounded(
        self, ask: Callable[[str], Sequence[_V]], names: Iterable[str], until: float
    ) -> list[_V]:
        found: list[_V] = []
        for name in names:
            found += ask(name)
            _few(found, MOST_ENDS, "endpoints")
            if time.monotonic() > until:
                raise SourceError("the domain tells more than there is time for", help=_HELP)
        return found

    def _others(self, ends: Iterable[_T]) -> list[_T]:
        return [end for end in ends if not self._is_own(end)]

    def _is_own(self, end: Ros2Endpoint | Ros2ServiceEnd) -> bool:
        if not end.gid:
            return end.node == self._own_name
        return end.participant == self._participant


class _Texts:
    """Makes a SourceError of names that are no UTF-8: rclpy then tells nothing of what is there."""

    def __enter__(self) -> None:
        pass

    def __exit__(self, _type: object, error: BaseException | None, _traceback: object) -> None:
        if isinstance(error, UnicodeError):
            message = "somebody in the domain uses names that are no text"
            raise SourceError(message, help=_HELP) from error


_HELP = "is this the app's domain (--domain)? somebody there may want to be in the way"


def _names(told: Iterable[tuple[str, list[str]]], what: str) -> list[str]:
    return _few([name for name, _ in told], MOST_NAMES, what)


_U = TypeVar("_U")


def _few(found: list[_U], most: int, what: str) -> list[_U]:
    if len(found) > most:
        raise SourceError(f"the domain has more than {most} {what}", help=_HELP)
    return found


def _asks(service: str) -> bool:
    """Tell whether a service is one of an action's, whose clients count."""
    return service.endswith(_ACTIONS)


def _sorted(ends: Iterable[_T]) -> tuple[_T, ...]:
    return tuple(sorted(ends, key=lambda end: (end.node, str(end))))
