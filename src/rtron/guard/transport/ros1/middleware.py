"""The guard's transport for ROS 1: many nodes in one process, raw messages, no rospy."""

import logging
import socket
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from rtron.guard.core.event_loop import Loop
from rtron.guard.transport.common.protocol import (
    Connect,
    Lost,
    Momentary,
    Output,
    TypeInfo,
    ignore,
    never,
)
from rtron.guard.transport.ros1.handshake import Wish
from rtron.guard.transport.ros1.node import Node
from rtron.guard.transport.ros1.publication import Publication
from rtron.guard.transport.ros1.publisher_link import start
from rtron.guard.transport.ros1.registrar import Registrar
from rtron.guard.transport.ros1.subscriber_link import SubscriberLink
from rtron.guard.transport.ros1.subscription import Subscription
from rtron.guard.transport.ros1.tcp_server import TcpServer
from rtron.messages.common.encoding import Encoding
from rtron.wire.ros1.host_address import bind_host, own_host

log = logging.getLogger(__name__)

_WORKERS = 4


class Ros1Transport:
    """Nodes, topics and a clock on ROS 1; everything happens in the loop's thread.

    `public` is the master's address that others are told, where it is not the one we use.
    """

    encoding = Encoding.ROS1

    def __init__(
        self, loop: Loop, master: str, host: str | None = None, *, public: str = ""
    ) -> None:
        self._loop = loop
        self._master = master
        self._public = public or master
        self._host = host or own_host()
        self._nodes: dict[str, Node] = {}
        self._publications: dict[str, Publication] = {}
        self._workers: list[ThreadPoolExecutor] = []
        self._server = TcpServer(loop, bind_host(self._host), self._accepted)
        self._registrar = Registrar(loop, master, lambda: list(self._nodes.values()))
        self.killed: Callable[[str, str], None] = lambda node, reason: None
        self.listened: Callable[[str, str], None] = lambda topic, node: None
        self.now = loop.now
        self.call_at = loop.call_at

    def advertise(
        self,
        node: str,
        topic: str,
        type: str,
        *,
        queue_size: int = 100,
        successors: tuple[str, ...] = (),
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`."""
        publication = _Announced(
            node, topic, type, self.now, queue_size=queue_size, successors=successors
        )
        owner = self._node(node)
        owner.publications[topic] = self._publications[topic] = publication
        publication.typed = lambda: self._registrar.publish(owner, topic)
        self._registrar.publish(owner, topic)
        return publication

    def subscribe(
        self,
        node: str,
        topic: str,
        type: str,
        connect: Connect,
        lost: Lost = ignore,
        *,
        momentary: Momentary = never,
        publishers: tuple[str, ...] = (),
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`. ROS 1 tells no message's age."""
        del momentary, publishers
        wish = Wish(node, topic, type, self._master)
        link = start(self._loop, self._own_workers(topic), wish, connect, lost)
        self._subscribe(node, Subscription(topic, type, link))

    def join(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of ours as connected; see `Transport`."""
        output = self.advertise(publisher, topic, type)
        wish = Wish(subscriber, topic, type, self._master)
        link = start(self._loop, self._own_workers(topic), wish, lambda peer: None, ignore)
        self._subscribe(subscriber, Subscription(topic, type, link, joined=True))
        return output

    @property
    def port(self) -> int:
        """The TCPROS port that every node of ours answers at."""
        return self._server.port

    def addresses(self) -> dict[str, str]:
        """Return the URI of each node of ours."""
        return {name: node.uri for name, node in self._nodes.items()}

    def listeners(self, topic: str) -> set[str]:
        """Return what the subscribers that are connected to a topic of ours call themselves."""
        publication = self._publications.get(topic)
        return {link.node for link in publication.links} if publication else set()

    def reclaim(self, name: str) -> None:
        """Register all of a node again: the master gives a name to who took it last."""
        if name in self._nodes:
            self._registrar.everything(self._nodes[name])

    def remove(self, name: str) -> None:
        """Take a node out of the graph."""
        node = self._nodes.pop(name, None)
        if node:
            self._registrar.leave(node)
            for topic in node.publications:
                self._publications.pop(topic, None)
            node.close()

    def close(self) -> None:
        """Unregister everything and close every connection."""
        for name in list(self._nodes):
            self.remove(name)
        self._server.close()
        for workers in self._workers:
            workers.shutdown(wait=False, cancel_futures=True)
        self._registrar.close()

    def _own_workers(self, topic: str) -> ThreadPoolExecutor:
        """Give a subscription its own threads: publishers that hang delay no other topic."""
        self._workers.append(ThreadPoolExecutor(_WORKERS, thread_name_prefix=topic))
        return self._workers[-1]

    def _node(self, name: str) -> Node:
        if name not in self._nodes:
            node = Node(self._loop, name, self._host, self._public)
            node.tcpros = (self._host, self._server.port)
            node.updated = lambda topic: self._registrar.subscribe(node, topic)
            node.killed = lambda reason: self.killed(name, reason)
            self._nodes[name] = node
        return self._nodes[name]

    def _subscribe(self, name: str, subscription: Subscription) -> None:
        node = self._node(name)
        node.subscriptions[subscription.topic] = subscription
        self._registrar.subscribe(node, subscription.topic)

    def _accepted(self, sock: socket.socket) -> None:
        SubscriberLink(self._loop, sock, self._opened)

    def _opened(self, link: SubscriberLink, fields: dict[str, str]) -> None:
        publication = self._publications.get(fields.get("topic", ""))
        if publication is None:
            link.refuse(f"the guard does not publish {fields.get('topic', '')!r}")
        else:
            publication.admit(link, fields)
            self.listened(publication.topic, link.node)


class _Announced(Publication):
    """A publication that is registered once its type is known."""

    typed: Callable[[], None]

    def learn(self, info: TypeInfo) -> bool:
        waiting = not self.type
        agreed = super().learn(info)
        if waiting and agreed:
            self.typed()
        return agreed
