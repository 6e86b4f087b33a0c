"""Rehearsals on ROS 1: a message goes over two TCP connections of the guard with itself."""

import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.common.memory import Stage
from rtron.guard.transport.common.protocol import (
    DEFAULT_OUTPUT,
    MessageHandler,
    Output,
    OutputOptions,
)
from rtron.guard.transport.ros1.publication import Publication
from rtron.guard.transport.ros1.subscriber_link import SubscriberLink
from rtron.guard.transport.ros1.tcp_server import set_socket_options
from rtron.messages.common.encoding import Encoding
from rtron.wire.ros1.tcpros import FrameReader

_CHUNK = 1 << 14
_HOST = "127.0.0.1"


class Ros1Stage(Stage):
    """Receives and sends as the guard does, with an event loop of its own that is never waited for.

    The connections are not announced; their port is open only until both ends are there.
    """

    def __init__(self, now: Callable[[], int]) -> None:
        super().__init__(Encoding.ROS1, now)
        self._loop = EventLoop()
        self._reader = FrameReader()
        self._is_waiting = False
        self._receive: MessageHandler | None = None
        self._source, self._input = _connected_pair()
        output, self._sink = _connected_pair()
        self._loop.watch(self._input, self._on_readable, lambda error: None)
        self._link = SubscriberLink(self._loop, output, lambda link, fields: None)
        self._link.md5sum = "*"

    def advertise(
        self, node: str, topic: str, type: str, options: OutputOptions = DEFAULT_OUTPUT
    ) -> Output:
        """Publish to one subscriber where a successor is expected, else to none."""
        publication = Publication(node, topic, type, self.now, replace(options, successors=()))
        if options.successors:
            publication.links.append(self._link)
        return publication

    def arrive(self, message: bytes) -> None:
        """Send a message to the input, unless one is on the way."""
        if not self._is_waiting:
            self._is_waiting = True
            self._source.send(message)

    def handle(self, receive: MessageHandler) -> None:
        """Look at the sockets, as the guard's loop does."""
        self._receive = receive
        self._loop.step(0)

    def take_output(self) -> None:
        """Take what has come out, so that the connection does not fill."""
        with suppress(BlockingIOError):
            self._sink.recv(_CHUNK)

    def close(self) -> None:
        """Close the connections."""
        self._link.close()
        self._loop.forget(self._input)
        for sock in (self._source, self._sink):
            sock.close()
        self._loop.close()

    def _on_readable(self) -> None:
        for frame in self._reader.feed(self._input.recv(_CHUNK)):
            self._is_waiting = False
            if self._receive:
                self._receive(frame)


def _connected_pair() -> tuple[socket.socket, socket.socket]:
    """Return both ends of a TCP connection, non-blocking."""
    with socket.create_server((_HOST, 0)) as server:
        first = socket.create_connection(server.getsockname())
        second, address = server.accept()
        while address != first.getsockname():  # somebody else was faster
            second.close()
            second, address = server.accept()
    for sock in (first, second):
        sock.settimeout(0)
        set_socket_options(sock)
    return first, second
