"""ROS 1 by hand: peers that break the protocol, or keep to it without a client library."""

import socket
import struct
import threading
from contextlib import suppress
from xmlrpc.server import SimpleXMLRPCServer

from typing_extensions import Self

from rtron.wire.ros1.tcpros import FrameReader, decode_header, encode_header
from rtron.wire.ros1.xmlrpc import ros_call

TWIST = "geometry_msgs/Twist"
TWIST_MD5 = "9f195f881246fdfa2798d1d3eebca84a"
LIMIT_S = 60.0


def twist(number: int) -> bytes:
    return struct.pack("<I6d", 48, float(number), 0, 0, 0, 0, 0)


def tcpros_port(guard_node: str, topic: str) -> int:
    protocol = ros_call(guard_node, "requestTopic", "/raw", topic, [["TCPROS"]], timeout=LIMIT_S)
    return protocol[2]


def subscriber_header(topic: str, **fields: str) -> dict[str, str]:
    given = {"callerid": "/raw", "topic": topic, "type": TWIST, "md5sum": TWIST_MD5}
    return {name: text for name, text in (given | fields).items() if text}


class RawSubscriber:
    """Connects to a publisher's TCPROS port and says whatever the test wants."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("localhost", port), LIMIT_S)
        self._reader = FrameReader()
        self._frames: list[bytes] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def ask(self, topic: str, **fields: str) -> None:
        self.socket.sendall(encode_header(subscriber_header(topic, **fields)))

    def subscribe(self, topic: str, **fields: str) -> dict[str, str]:
        self.ask(topic, **fields)
        return decode_header(self.frame()[4:])

    def frame(self) -> bytes:
        while not self._frames:
            data = self.socket.recv(1 << 16)
            if not data:
                raise ConnectionError("closed by the guard")
            self._frames += self._reader.feed(data)
        return self._frames.pop(0)


class RawPublisher:
    """A node with a slave API of three methods, which announces and sends whatever it is told."""

    def __init__(self, master: str, name: str, topic: str, **header: str) -> None:
        self.name, self.topic, self._master = name, topic, master
        self._header = {"type": TWIST, "md5sum": TWIST_MD5, "callerid": name} | header
        self.connections: list[socket.socket] = []
        self._listener = socket.create_server(("localhost", 0))
        self._slave = SimpleXMLRPCServer(("localhost", 0), logRequests=False)
        self._slave.register_function(self._request_topic, "requestTopic")
        self._slave.register_function(lambda *_: [1, "", 0], "publisherUpdate")
        self.uri = f"http://localhost:{self._slave.server_address[1]}/"
        works = (self._slave.serve_forever, self._accept)
        self._threads = [threading.Thread(target=work, daemon=True) for work in works]
        for thread in self._threads:
            thread.start()
        ros_call(master, "registerPublisher", name, topic, TWIST, self.uri, timeout=LIMIT_S)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        named = (self.name, self.topic, self.uri)
        try:
            ros_call(self._master, "unregisterPublisher", *named, timeout=LIMIT_S)
        finally:
            self._close()

    def send(self, data: bytes) -> None:
        for connection in list(self.connections):
            self._send(connection, data)

    def _send(self, connection: socket.socket, data: bytes) -> None:
        try:
            connection.sendall(data)
        except ConnectionError:  # the guard has left it, for another one or for good
            self.connections.remove(connection)
            connection.close()

    def _request_topic(self, *_: object) -> list[object]:
        return [1, "", ["TCPROS", "localhost", self._listener.getsockname()[1]]]

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            connection.settimeout(LIMIT_S)
            try:
                connection.recv(1 << 16)
                connection.sendall(encode_header(self._header))
                self.connections.append(connection)
            except OSError:  # the guard has left
                connection.close()

    def _close(self) -> None:
        self._slave.shutdown()
        self._slave.server_close()
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        for thread in self._threads:
            thread.join()
        for closed in (self._listener, *self.connections):
            closed.close()
