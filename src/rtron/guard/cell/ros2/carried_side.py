"""A transport in a cell of ROS 2, for a process outside: a carrier inside does the work."""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from typing_extensions import assert_never

from rtron.errors import WireError
from rtron.guard.cell.connection import BEAT_S
from rtron.guard.cell.ros2.carrier_channel import CarrierChannel, TopicData
from rtron.guard.cell.ros2.messages import (
    FROM_CARRIER,
    Beat,
    FromCarrier,
    Introduce,
    NewSubscriber,
    PublisherFound,
    PublisherLost,
    Seen,
    ServiceState,
    Subscribe,
    Subscribers,
)
from rtron.guard.supervision.watchdog import SchedulingDelay, Watchdog, adapt_bound
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from rtron.guard.cell.ros2.carried_output import CarriedOutput
    from rtron.guard.cell.ros2.messages import ToCarrier
    from rtron.guard.cell.ros2.service_relay import CarriedCalls
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import (
        ConnectHandler,
        InputOptions,
        LostHandler,
        MessageHandler,
        Peer,
    )

_SILENCE_LIMIT = SECOND
_LONGEST_LIMIT = 3 * SECOND
"""How long a carrier may be silent. The stopper in the cell stops the robot sooner; another carrier
takes seconds to start on a busy machine, and makes it busier.
"""
_START_LIMIT = 10 * SECOND
"""How long a carrier may take to answer first: it may just be starting."""


class CarriedSide:
    """Has no more of a transport than a cell needs.

    A carrier that answers no beat is given up, as one that is gone.
    """

    def __init__(
        self, loop: EventLoop, carrier: socket.socket, role: bytes, on_lost: Callable[[], None]
    ) -> None:
        self._loop = loop
        self._on_lost = on_lost
        self._is_open = True
        self._numbers = count(1)
        self._outputs: dict[int, CarriedOutput] = {}
        self._handlers: dict[int, tuple[ConnectHandler, LostHandler]] = {}
        self._publishers: dict[int, tuple[Peer, MessageHandler, LostHandler]] = {}
        self._services: dict[int, CarriedCalls] = {}
        self._answers = 0
        self._watchdog = Watchdog(loop.now())
        self._delay = SchedulingDelay(loop.now(), int(BEAT_S * SECOND))
        self._channel = CarrierChannel(
            loop, carrier, FROM_CARRIER, self._receive, self._receive_data, self._lose
        )
        self.send(Introduce(role.decode()))
        self._beat()

    def send(self, message: ToCarrier) -> None:
        """Send to the carrier."""
        self._channel.send(message)

    def send_data(self, id: int, message: bytes, tag: int) -> bool:
        """Send a message of an output or a service; see `CarrierChannel`."""
        return self._channel.send_data(id, message, tag)

    def add_service(self, calls: CarriedCalls) -> int:
        """Return the number under which the carrier knows a service."""
        number = next(self._numbers)
        self._services[number] = calls
        return number

    def add_output(self, output: CarriedOutput) -> int:
        """Return the number under which the carrier knows an output."""
        number = next(self._numbers)
        self._outputs[number] = output
        return number

    def subscribe(
        self, node: str, topic: str, type: str, on_connect: ConnectHandler, options: InputOptions
    ) -> None:
        """Subscribe `topic` as `node` inside; see `Transport`."""
        number = next(self._numbers)
        self._handlers[number] = (on_connect, options.on_lost)
        self.send(
            Subscribe(
                id=number,
                node=node,
                topic=topic,
                type=type,
                publishers=options.publishers,
                queue_size=options.queue_size,
                keep_all=options.keep_all,
            )
        )

    def abandon(self) -> None:
        """Leave the carrier, which ends with its connection."""
        self.close()

    def close(self) -> None:
        """Leave the carrier."""
        self._on_lost = lambda: None
        self._channel.close()

    def _lose(self) -> None:
        self._is_open = False
        for peer, _, on_lost in list(self._publishers.values()):
            on_lost(peer)
        self._publishers.clear()
        for output in self._outputs.values():
            output.nodes = frozenset()
        for service in self._services.values():
            service.set_available(is_available=False)
        self._on_lost()

    def _beat(self) -> None:
        if not self._is_open:
            return
        self.send(Beat())
        self._loop.call_later(BEAT_S, self._beat)
        now = self._loop.now()
        limit = adapt_bound(_SILENCE_LIMIT, self._delay.update(now), _LONGEST_LIMIT)
        silence = self._watchdog.update(now, self._answers)
        if silence > (limit if self._answers else _START_LIMIT):
            self._channel.close()

    def _receive_data(self, data: TopicData) -> None:
        if data.id in self._publishers:
            self._publishers[data.id][1](data.message)
        elif data.id in self._services:
            self._services[data.id].receive(data.tag, data.message)

    def _receive(self, message: FromCarrier) -> None:
        match message:
            case Beat():
                self._answers += 1
            case PublisherFound():
                self._add_publisher(message)
            case PublisherLost(connection):
                if connection in self._publishers:
                    peer, _, on_lost = self._publishers.pop(connection)
                    on_lost(peer)
            case Subscribers(id, nodes):
                self._output(id).nodes = nodes
            case NewSubscriber(id):
                self._output(id).send_greeting()
            case ServiceState(id, is_available):
                self._service(id).set_available(is_available=is_available)
            case Seen():
                raise WireError("it answers what nobody asked")
            case _:
                assert_never(message)

    def _add_publisher(self, found: PublisherFound) -> None:
        if found.subscription not in self._handlers or found.connection in self._publishers:
            raise WireError("it tells of a publisher that nobody asked for")
        on_connect, on_lost = self._handlers[found.subscription]
        if handler := on_connect(found.peer):
            self._publishers[found.connection] = (found.peer, handler, on_lost)

    def _service(self, id: int) -> CarriedCalls:
        if id not in self._services:
            raise WireError("it tells of a service that nobody requested")
        return self._services[id]

    def _output(self, id: int) -> CarriedOutput:
        if id not in self._outputs:
            raise WireError("it tells of an output that nobody has")
        return self._outputs[id]
