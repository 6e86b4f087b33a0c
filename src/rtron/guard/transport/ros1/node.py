"""A ROS 1 node of the guard: its topics, and the slave API that the graph's tools call.

ROS wiki: Slave_API. A caller may not be the master, so `publisherUpdate` only makes us ask the
master itself.
"""

import os
import socket
from typing import TYPE_CHECKING, Any

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros1.http_connection import XmlRpcConnection
from rtron.guard.transport.ros1.tcp_server import TcpServer
from rtron.wire.ros1.network import HOST_NETWORK, Network, bind_address

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.transport.ros1.publication import Publication
    from rtron.guard.transport.ros1.subscription import Subscription

_ERROR, _SUCCESS = -1, 1
_MAX_TEXT = 100


class Ros1Node:
    """One name in the ROS graph, reachable at its own XML-RPC address."""

    def __init__(
        self,
        loop: EventLoop,
        name: str,
        host: str,
        master: str,
        network: Network = HOST_NETWORK,
    ) -> None:
        self.name = name
        self.master = master
        self.publications: dict[str, Publication] = {}
        self.subscriptions: dict[str, Subscription] = {}
        self.on_publisher_update: Callable[[str], None] = lambda topic: None
        self.on_shutdown_request: Callable[[str], None] = lambda reason: None
        self.tcpros_address: tuple[str, int] = (host, 0)
        self._loop = loop
        self._server = TcpServer(loop, bind_address(host), self._on_connection, network=network)
        self.uri = f"http://{host}:{self._server.port}/"
        self._methods: dict[str, tuple[int, Callable[..., Any]]] = {
            "getBusInfo": (1, self._bus_info),
            "getBusStats": (1, self._bus_stats),
            "getMasterUri": (1, lambda caller: self.master),
            "getPid": (1, lambda caller: os.getpid()),
            "getParentPid": (1, lambda caller: os.getppid()),
            "getSubscriptions": (1, self._subscriptions),
            "getPublications": (1, self._publications),
            "paramUpdate": (3, lambda caller, key, value: 0),
            "publisherUpdate": (3, self._publisher_update),
            "requestTopic": (3, self._request_topic),
            "shutdown": (2, self._shutdown),
        }

    def close(self) -> None:
        """Close every connection and the slave API."""
        for publication in self.publications.values():
            publication.close()
        for subscription in self.subscriptions.values():
            subscription.close()
        self.publications.clear()
        self.subscriptions.clear()
        self._server.close()

    def dispatch(self, method: str, params: tuple[Any, ...]) -> list[Any]:
        """Answer a call of the slave API with `[code, message, value]`."""
        count, answer = self._methods.get(method, (0, None))
        if answer is None:
            return [_ERROR, f"{self.name} has no method {method}", 0]
        if method == "shutdown" and len(params) == 1:
            params = (*params, "")
        if len(params) != count:
            return [_ERROR, f"{method} takes {count} parameters", 0]
        value = answer(*params)
        if value is None:
            return [_ERROR, f"{self.name} cannot do that", 0]
        return [_SUCCESS, "", value]

    def _on_connection(self, sock: socket.socket) -> None:
        XmlRpcConnection(self._loop, sock, self.dispatch)

    def _request_topic(self, _caller: str, topic: Any, protocols: Any) -> list[Any] | None:  # noqa: ANN401
        requested = protocols if isinstance(protocols, list) else []
        if (
            not isinstance(topic, str)
            or topic not in self.publications
            or ["TCPROS"] not in requested
        ):
            return None
        return ["TCPROS", *self.tcpros_address]

    def _publisher_update(self, _caller: str, topic: Any, _publishers: Any) -> int:  # noqa: ANN401
        if isinstance(topic, str) and topic in self.subscriptions:
            self.on_publisher_update(topic)
        return 0

    def _shutdown(self, caller: str, reason: Any) -> int:  # noqa: ANN401
        self._loop.call_after_event(
            lambda: self.on_shutdown_request(f"{_shorten(caller)} asked for it: {_shorten(reason)}")
        )
        return 0

    def _subscriptions(self, _caller: str) -> list[list[str]]:
        return [[s.topic, s.type or "*"] for s in self.subscriptions.values()]

    def _publications(self, _caller: str) -> list[list[str]]:
        return [[p.topic, p.type or "*"] for p in self.publications.values()]

    def _bus_info(self, _caller: str) -> list[list[Any]]:
        rows: list[list[Any]] = []
        for topic, publication in self.publications.items():
            rows += [
                [id(link) % (1 << 31), link.node, "o", "TCPROS", topic, True, link.address]
                for link in publication.links
            ]
        for topic, subscription in self.subscriptions.items():
            rows += [
                [id(link) % (1 << 31), link.uri, "i", "TCPROS", topic, link.is_connected, link.node]
                for link in subscription.links.values()
            ]
            if subscription.is_internal:
                rows += [
                    [0, uri, "i", "INTRAPROCESS", topic, True, "inside the guard"]
                    for uri in subscription.own_uris
                ]
        return rows

    def _bus_stats(self, _caller: str) -> list[list[Any]]:
        return [self._publish_stats(), self._subscribe_stats(), []]

    def _publish_stats(self) -> list[list[Any]]:
        return [
            [
                topic,
                sum(link.sent_bytes for link in publication.links) % (1 << 31),
                [
                    [id(k) % (1 << 31), k.sent_bytes % (1 << 31), k.sent % (1 << 31), True]
                    for k in publication.links
                ],
            ]
            for topic, publication in self.publications.items()
        ]

    def _subscribe_stats(self) -> list[list[Any]]:
        return [
            [
                topic,
                [
                    [
                        id(link) % (1 << 31),
                        link.received_bytes % (1 << 31),
                        link.received % (1 << 31),
                        -1,
                        link.is_connected,
                    ]
                    for link in subscription.links.values()
                ],
            ]
            for topic, subscription in self.subscriptions.items()
        ]


def _shorten(value: object) -> str:
    """Return what a caller says, which may be long, as it is logged and sent on."""
    return str(value)[:_MAX_TEXT]
