"""Publishers that go past the guard: raw, so that they keep to no rule of a client library.

`first_connection` is when the first subscriber's connection was accepted, on the steady clock (ns);
`message_count` is how often the velocity was said, to nobody too.
"""

import socket
import struct
import time
from contextlib import suppress
from threading import Event, Thread
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

from typing_extensions import Self

from bench.ros1.node import HOST, read_header
from rtron.errors import RTronError
from rtron.wire.ros1.tcpros import encode_header
from rtron.wire.ros1.xmlrpc import ros_call

TWIST = "geometry_msgs/Twist"
TWIST_MD5 = "9f195f881246fdfa2798d1d3eebca84a"
FASTEST = struct.pack("<I6d", 48, 0, 0, 0, 0, 0, -0.2)
_RATE = 200
_REPEAT_S = 0.02
_CALL_S = 5.0


class Intruder:
    """Serves a topic at an address of its own and says one velocity to whoever connects."""

    def __init__(self, name: str, topic: str, rate: int = _RATE) -> None:
        """Say it `rate` times a second."""
        self.name, self.topic = name, topic
        self.first_connection = 0
        self.connection_count = self.message_count = 0
        self._period_s = 1 / rate
        self.shut_down = Event()
        self._connections: list[socket.socket] = []
        self._listener = socket.create_server((HOST, 0))
        self._slave = SimpleXMLRPCServer((HOST, 0), logRequests=False, allow_none=True)
        port = self._listener.getsockname()[1]
        self._answer("requestTopic", ["TCPROS", HOST, port])
        self._answer("getPid", 1)
        self._answer("getBusInfo", [])
        self._answer("getPublications", [[topic, TWIST]])
        self._answer("publisherUpdate", 0)
        self._slave.register_function(self._shut, "shutdown")
        self.uri = f"http://{HOST}:{self._slave.server_address[1]}/"
        works = (self._slave.serve_forever, self._accept, self._publish)
        self._threads = [Thread(target=work, daemon=True) for work in works]
        for thread in self._threads:
            thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.leave()

    @property
    def has_subscriber(self) -> bool:
        """Whether a subscriber is connected."""
        return bool(self._connections)

    def register(self, master: str) -> None:
        """Join the graph of a master, as a publisher of the topic."""
        ros_call(master, "registerPublisher", self.name, self.topic, TWIST, self.uri, timeout=5)

    def unregister(self, master: str) -> None:
        """Leave the graph of a master."""
        ros_call(master, "unregisterPublisher", self.name, self.topic, self.uri, timeout=5)

    def announce_to(self, subscriber: str, *others: str) -> None:
        """Tell a subscriber, in the master's place, that this is a publisher beside `others`."""
        uris = [*others, self.uri]
        ros_call(subscriber, "publisherUpdate", "/master", self.topic, uris, timeout=_CALL_S)

    def announce_through(self, master: str, subscriber: str, uri: str) -> None:
        """Register a subscriber at another master, which tells it of its own publishers."""
        ros_call(master, "registerSubscriber", subscriber, self.topic, TWIST, uri, timeout=_CALL_S)
        self.register(master)

    def leave(self) -> None:
        """End every connection, and serve no more."""
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()  # says no more, while the slave's end takes half a second
        self._slave.shutdown()
        self._slave.server_close()
        for thread in self._threads:
            thread.join()
        for connection in self._connections:
            connection.close()

    def _answer(self, method: str, value: object) -> None:
        self._slave.register_function(lambda *_: [1, "", value], method)

    def _shut(self, *_: Any) -> list[Any]:  # noqa: ANN401 - whatever a caller says
        self.shut_down.set()
        return [1, "", 0]

    def _accept(self) -> None:
        while True:
            try:
                sock, _ = self._listener.accept()
            except OSError:
                return
            self.first_connection = self.first_connection or time.monotonic_ns()
            self.connection_count += 1
            try:
                self._welcome(sock)
            except (OSError, RTronError):
                sock.close()

    def _welcome(self, sock: socket.socket) -> None:
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        read_header(sock)
        header = {"callerid": self.name, "topic": self.topic, "type": TWIST, "md5sum": TWIST_MD5}
        sock.sendall(encode_header({**header, "message_definition": "", "latching": "0"}))
        self._connections.append(sock)

    def _publish(self) -> None:
        while self._listener.fileno() >= 0:
            time.sleep(self._period_s)
            self.message_count += 1
            for sock in [each for each in self._connections if not _spoken(each)]:
                self._connections.remove(sock)


class RepeatingGhost(Intruder):
    """Tells a node every 20 ms that it and `others`, nobody else, publish the topic."""

    def __init__(self, name: str, topic: str, rate: int, node: str, *others: str) -> None:
        super().__init__(name, topic, rate)
        self._uris = (node, *others)
        self._has_left = Event()
        self._repeating = Thread(target=self._repeat)

    def __enter__(self) -> Self:
        self._repeating.start()
        return self

    def leave(self) -> None:
        """Tell it no more, and end every connection."""
        self._has_left.set()
        self._repeating.join()
        super().leave()

    def _repeat(self) -> None:
        while not self._has_left.wait(_REPEAT_S):
            with suppress(RTronError):
                self.announce_to(*self._uris)


def _spoken(sock: socket.socket) -> bool:
    """Say the velocity; close the connection and return False if nobody listens any more."""
    try:
        sock.sendall(FASTEST)
    except OSError:
        sock.close()
        return False
    return True
