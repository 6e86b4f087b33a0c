"""A process in a cell that carries topics for one client outside, with a participant of its own.

A participant cannot be handed out as a socket can. So each process of the guard has a carrier,
which does inside what is requested and ends with the connection. Beats go through it to the
stopper, with its own: so the stopper can tell a guard that is gone from a carrier that is.
"""

from __future__ import annotations

import logging
import os
import socket
from contextlib import suppress
from functools import partial
from itertools import count
from typing import TYPE_CHECKING

from typing_extensions import assert_never

from rtron.errors import WireError
from rtron.guard.cell.access import CARRIER_BEAT, FAREWELL, GUARD_BEAT, MAX_PACKET, WATCH
from rtron.guard.cell.connection import BEAT_S
from rtron.guard.cell.ros2.carrier_channel import CarrierChannel, TopicData
from rtron.guard.cell.ros2.inner_services import InnerServices
from rtron.guard.cell.ros2.messages import (
    TO_CARRIER,
    Beat,
    CallService,
    ClearLatched,
    Introduce,
    Look,
    NewSubscriber,
    OfferService,
    Publish,
    PublisherFound,
    PublisherLost,
    Seen,
    SeenEndpoint,
    Subscribe,
    Subscribers,
    ToCarrier,
)
from rtron.guard.core.printable import printable
from rtron.guard.transport.common.protocol import InputOptions, MessageHandler, Output, Peer
from rtron.guard.transport.ros2.graph_query import GraphQuery
from rtron.vocabulary import GUARD_NODE, SECOND, Direction

if TYPE_CHECKING:
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.wire.ros2.endpoints import Ros2Endpoint

log = logging.getLogger(__name__)

_REPORT_S = 0.1
_FIRST_CONNECTION = 1 << 24
"""Connections have higher numbers than what the client has numbered."""
_MAX_NODES = 2000
_LATE = 3 * SECOND // 10
"""How old a guard's message may be that is not latched, ns: who was frozen finds more of them."""


class Carrier:
    """Serves one client until it is gone: then the loop stops."""

    def __init__(
        self, loop: EventLoop, transport: Ros2Transport, client: socket.socket, access: str
    ) -> None:
        """`access` is the path of the cell's socket, where the stopper takes beats."""
        self._loop = loop
        self._transport = transport
        self._access = access
        self._beats: socket.socket | None = None
        self._outputs: dict[int, Output] = {}
        self._publications: dict[int, Publish] = {}
        self._nodes: dict[int, frozenset[str]] = {}
        self._connections: dict[int, tuple[Peer, int]] = {}
        """The publishers' numbers by what their peers are: two may have one name."""
        self._numbers = count(_FIRST_CONNECTION)
        self._channel = CarrierChannel(
            loop, client, TO_CARRIER, self._receive, self._publish, self._end
        )
        self._services = InnerServices(transport, self._channel)
        self._report()

    def _end(self) -> None:
        """Say that it is the client that has ended, and end."""
        self._pass_on(FAREWELL)
        self._loop.stop()

    def _publish(self, data: TopicData) -> None:
        if self._services.has(data.id):
            self._services.receive(data)
            return
        is_late = self._beats and not data.tag and self._loop.now() - data.sent_at > _LATE
        if not is_late:
            latched_by = str(data.tag) if data.tag else None
            self._output(data.id).publish(data.message, latched_by)

    def _receive(self, message: ToCarrier) -> None:
        match message:
            case Beat():
                self._pass_on(GUARD_BEAT)
                self._channel.send(Beat())
            case Introduce(role):
                log.info("carrier %d: %s", os.getpid(), printable(role))
                self._connect_beats(role.encode())
            case Publish():
                self._change_output(message)
            case ClearLatched(id):
                self._output(id).clear_latched()
            case Subscribe():
                self._subscribe(message)
            case OfferService():
                self._services.offer(message)
            case CallService():
                self._services.open_client(message)
            case Look(topics):
                self._look(topics)
            case _:
                assert_never(message)

    def _change_output(self, publication: Publish) -> None:
        """Publish a topic, and do what it asks for now, and did not before."""
        before = self._publications.get(publication.id)
        if before is None:
            self._outputs[publication.id] = self._transport.advertise(
                publication.node, publication.topic, publication.type, publication.options
            )
        self._publications[publication.id], output = publication, self._outputs[publication.id]
        if publication.info:
            output.learn_type(publication.info)
        if publication.matched and not (before and before.matched):
            output.match_subscribers(publication.matched)
        for flow, qos in publication.offers.items():
            output.offer(flow, qos)
        if publication.is_greeting and not (before and before.is_greeting):
            output.greet(partial(self._request_greeting, publication.id))

    def _output(self, id: int) -> Output:
        if id not in self._outputs:
            raise WireError("it speaks of an output that it has not requested")
        return self._outputs[id]

    def _connect_beats(self, role: bytes) -> None:
        if role == WATCH:
            return
        beats = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        beats.connect(self._access)
        beats.settimeout(0)
        beats.send(role)
        self._loop.watch(beats, partial(_take_greeting, beats), partial(self._reconnect, role))
        is_first, self._beats = self._beats is None, beats
        if is_first:
            self._beat()

    def _reconnect(self, role: bytes, error: Exception) -> None:
        """Wait at the cell's socket for the next stopper."""
        log.warning("%s", error)
        if self._beats:
            self._loop.forget(self._beats)
        self._connect_beats(role)

    def _beat(self) -> None:
        self._pass_on(CARRIER_BEAT)
        self._loop.call_later(BEAT_S, self._beat)

    def _pass_on(self, packet: bytes) -> None:
        if self._beats:
            with suppress(OSError):  # full: it hangs; closed: the loop sees that
                self._beats.send(packet)

    def _request_greeting(self, id: int) -> None:
        self._channel.send(NewSubscriber(id))

    def _report(self) -> None:
        """Tell which of the expected nodes subscribe each output, and which services are there."""
        self._loop.call_later(_REPORT_S, self._report)
        self._services.report()
        for id, output in self._outputs.items():
            expected = self._publications[id].options.successors
            nodes = frozenset(each for each in expected if output.is_subscribed_by(each))
            if nodes != self._nodes.get(id):
                self._nodes[id] = nodes
                self._channel.send(Subscribers(id, nodes))

    def _subscribe(self, request: Subscribe) -> None:
        options = InputOptions(
            publishers=request.publishers,
            queue_size=request.queue_size,
            keep_all=request.keep_all,
            on_lost=self._lose,
        )
        connect = partial(self._connect, request.id)
        self._transport.subscribe(request.node, request.topic, request.type, connect, options)

    def _connect(self, subscription: int, peer: Peer) -> MessageHandler:
        number = next(self._numbers)
        self._connections[id(peer)] = peer, number
        self._channel.send(PublisherFound(subscription, number, peer))
        return partial(self._channel.send_data, number)

    def _lose(self, peer: Peer) -> None:
        _, number = self._connections.pop(id(peer))
        self._channel.send(PublisherLost(number))

    def _look(self, topics: tuple[str, ...]) -> None:
        """Tell what the domain inside has told us."""
        node = self._transport.session.node(GUARD_NODE)
        query = GraphQuery(node)
        found = (
            each
            for topic in topics
            for side in Direction
            for each in query.endpoints(topic, side, ())
        )
        names = node.get_node_names_and_namespaces()[:_MAX_NODES]
        nodes = tuple(f"{space.rstrip('/')}/{name}" for name, space in names)
        self._channel.send(Seen(tuple(map(_describe, found)), nodes))


def _take_greeting(stopper: socket.socket) -> None:
    """Take what the stopper gives with its greeting, which a carrier does not need."""
    data, descriptors, _, _ = socket.recv_fds(stopper, MAX_PACKET, MAX_PACKET)
    for each in descriptors:
        os.close(each)
    if not data:
        raise WireError("the stopper of the cell has ended")


def _describe(endpoint: Ros2Endpoint) -> SeenEndpoint:
    return SeenEndpoint(
        topic=endpoint.topic,
        is_publisher=endpoint.direction is Direction.PUBLISH,
        node=endpoint.node,
        type=endpoint.type,
        gid=endpoint.gid.hex(),
        qos=endpoint.qos,
    )
