"""The guard's transport for ROS 1: many nodes in one process, raw messages, no rospy."""

import logging
import socket
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    ConnectHandler,
    InputOptions,
    Output,
    OutputOptions,
    SubscriberProgress,
    TypeInfo,
)
from rtron.guard.transport.ros1.handshake import TopicRequest
from rtron.guard.transport.ros1.node import Ros1Node
from rtron.guard.transport.ros1.publication import Publication
from rtron.guard.transport.ros1.registrar import Registrar
from rtron.guard.transport.ros1.stage import Ros1Stage
from rtron.guard.transport.ros1.subscriber_link import KernelQueues, SubscriberLink
from rtron.guard.transport.ros1.subscription import Subscription, link_factory
from rtron.guard.transport.ros1.tcp_server import TcpServer
from rtron.messages.common.encoding import Encoding
from rtron.wire.ros1.network import HOST_NETWORK, Network, advertised_host, bind_address

log = logging.getLogger(__name__)

_WORKERS = 4


class Ros1Transport:
    """Nodes, topics and a clock on ROS 1; everything happens in the loop's thread.

    `public` is the master's address as other nodes know it, where it differs from `master`. All
    sockets are made in one `network`.
    """

    encoding = Encoding.ROS1

    def __init__(
        self,
        loop: EventLoop,
        master: str,
        host: str | None = None,
        *,
        public: str = "",
        network: Network = HOST_NETWORK,
    ) -> None:
        self._loop = loop
        self.master = master
        self._public = public or master
        self._host = host or advertised_host()
        self.network = network
        self._nodes: dict[str, Ros1Node] = {}
        self._publications: dict[str, Publication] = {}
        self._workers: dict[str, ThreadPoolExecutor] = {}
        self._queues = KernelQueues(network)
        address = bind_address(self._host)
        self._server = TcpServer(loop, address, self._on_connection, network=network)
        self._registrar = Registrar(loop, master, lambda: list(self._nodes.values()), network)
        self.on_shutdown_request: Callable[[str, str], None] = lambda node, reason: None
        self.on_subscriber: Callable[[str, str], None] = lambda topic, node: None
        self.on_subscriber_lost: Callable[[str, str], None] = lambda topic, node: None
        self.now = loop.now
        self.call_at = loop.call_at

    def advertise(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish `topic` as `node`; see `Transport`. In ROS 1 nobody is reliable but TCP."""
        publication = TypedPublication(node, topic, type, self.now, options)
        publication.on_subscriber_lost = lambda name: self.on_subscriber_lost(topic, name)
        self.add_publication(publication)
        return publication

    def add_publication(self, publication: "TypedPublication") -> None:
        """Publish what was published on a transport that has been abandoned, or is new."""
        owner, topic = self._node(publication.node), publication.topic
        owner.publications[topic] = self._publications[topic] = publication
        publication.on_type = lambda: self._registrar.publish(owner, topic)
        self._registrar.publish(owner, topic)

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node`; see `Transport`.

        ROS 1 tells neither the age of messages nor what a publisher's queue has dropped: a command
        is late only if it was latched before we listened.
        """
        request = TopicRequest(node, topic, type, self.master, self.network)
        workers = self._create_workers(topic)
        link = link_factory(self._loop, workers, request, on_connect, options)
        self._subscribe(node, Subscription(topic, type, link))

    def link_nodes(self, publisher: str, subscriber: str, topic: str, type: str) -> Output:
        """Show two nodes of ours as connected; see `Transport`."""
        output = self.advertise(publisher, topic, type)
        request = TopicRequest(subscriber, topic, type, self.master, self.network)
        link = link_factory(self._loop, self._create_workers(topic), request, lambda peer: None)
        self._subscribe(subscriber, Subscription(topic, type, link, is_internal=True))
        return output

    def set_shutdown_handler(self, handler: Callable[[str, str], None]) -> None:
        """Call `handler` with a node that others shut down, and why."""
        self.on_shutdown_request = handler

    def set_unreadable_handler(self, handler: Callable[[str, str, str], None]) -> None:
        """Do nothing: each connection logs its own errors."""

    def succeed(self, handover: HandoverState) -> None:
        """Do nothing: a node that registers again takes the place of the one before."""

    @property
    def participant(self) -> bytes:
        """Nothing: nodes are known by their names and addresses."""
        return b""

    def set_supervisor(self, participant: Callable[[], bytes]) -> None:
        """Do nothing: the supervisor's nodes are known by their names."""

    def subscriber_progress(self, topic: str) -> Sequence[SubscriberProgress]:
        """Return how far each subscriber of a topic has come; see `LiveTransport`."""
        publication = self._publications.get(topic)
        return [link.progress(self._queues) for link in publication.links] if publication else []

    def create_stage(self) -> Ros1Stage:
        """Return connections of the guard with itself; see `LiveTransport`."""
        return Ros1Stage(self.now)

    @property
    def port(self) -> int:
        """The TCPROS port of all our nodes."""
        return self._server.port

    def node_uris(self) -> dict[str, str]:
        """Return the URI of each node of ours."""
        return {name: node.uri for name, node in self._nodes.items()}

    def node_uri(self, name: str) -> str:
        """Return the URI of a node of ours, which is made if it is not there."""
        return self._node(name).uri

    def subscribers(self, topic: str) -> set[str]:
        """Return the names that the connected subscribers of a topic give themselves."""
        publication = self._publications.get(topic)
        return {link.node for link in publication.links} if publication else set()

    def all_subscribers(self) -> dict[str, list[str]]:
        """Return the names of the connected subscribers of each topic, the oldest first."""
        return {
            topic: list(dict.fromkeys(link.node for link in publication.links))
            for topic, publication in self._publications.items()
        }

    def register_node(self, name: str) -> None:
        """Register a node again: the master gives a name to the last one that registers it."""
        if name in self._nodes:
            self._registrar.register_all(self._nodes[name])

    def remove_publication(self, node: str, topic: str) -> None:
        """Publish a topic as a node no more; nothing if it does not."""
        owner = self._node(node)
        publication = owner.publications.pop(topic, None)
        if publication:
            self._publications.pop(topic, None)
            self._registrar.unpublish(owner, topic)
            publication.close()

    def remove_subscription(self, node: str, topic: str) -> None:
        """Subscribe to a topic as a node no more; nothing if it does not."""
        owner = self._node(node)
        subscription = owner.subscriptions.pop(topic, None)
        if subscription:
            self._registrar.unsubscribe(owner, topic)
            subscription.close()

    def abandon(self) -> None:
        """Close every connection, without a word to a master that is gone; the loop goes on."""
        self._registrar.abandon()
        for node in self._nodes.values():
            node.close()
        self._server.close()
        self._queues.close()
        for workers in self._workers.values():
            workers.shutdown(wait=False, cancel_futures=True)

    def close(self) -> None:
        """Unregister everything and close every connection."""
        self._close_all()
        self._registrar.close()

    def leave(self) -> None:
        """Unregister everything and close every connection, while the loop goes on."""
        self._close_all()
        self._registrar.close(wait=False)

    def _close_all(self) -> None:
        for node in self._nodes.values():
            self._registrar.unregister_all(node)
            node.close()
        self._nodes.clear()
        self._publications.clear()
        self._server.close()
        self._queues.close()
        for workers in self._workers.values():
            workers.shutdown(wait=False, cancel_futures=True)

    def _create_workers(self, topic: str) -> ThreadPoolExecutor:
        """Give a topic its own threads: publishers that hang delay no other topic."""
        if topic not in self._workers:
            self._workers[topic] = ThreadPoolExecutor(_WORKERS, thread_name_prefix=topic)
        return self._workers[topic]

    def _node(self, name: str) -> Ros1Node:
        if name not in self._nodes:
            node = Ros1Node(self._loop, name, self._host, self._public, self.network)
            node.tcpros_address = (self._host, self._server.port)
            node.on_publisher_update = lambda topic: self._registrar.subscribe(node, topic)
            node.on_shutdown_request = lambda reason: self.on_shutdown_request(name, reason)
            self._nodes[name] = node
        return self._nodes[name]

    def _subscribe(self, name: str, subscription: Subscription) -> None:
        node = self._node(name)
        node.subscriptions[subscription.topic] = subscription
        self._registrar.subscribe(node, subscription.topic)

    def _on_connection(self, sock: socket.socket) -> None:
        SubscriberLink(self._loop, sock, self._on_header)

    def _on_header(self, link: SubscriberLink, fields: dict[str, str]) -> None:
        publication = self._publications.get(fields.get("topic", ""))
        if publication is None:
            link.refuse(f"the guard does not publish {fields.get('topic', '')!r}")
        else:
            publication.add_subscriber(link, fields)
            self.on_subscriber(publication.topic, link.node)


class TypedPublication(Publication):
    """A publication that is registered once its type is known."""

    on_type: Callable[[], None]

    def learn_type(self, info: TypeInfo) -> bool:
        """Take the type; see `Publication`."""
        waiting = not self.type
        agreed = super().learn_type(info)
        if waiting and agreed:
            self.on_type()
        return agreed
