"""Publishers without a client library: whoever connects gets the frames as they are."""

import socket
from contextlib import suppress
from threading import Thread

from bench.ros1.messages import Message
from bench.ros1.node import HANDSHAKE_S, HOST, Node, read_header
from rtron.errors import RTronError
from rtron.wire.ros1.tcpros import encode_header


class Publishers:
    """Topics of one message type, each published by a node; one port serves them all."""

    def __init__(self, master: str, message: Message, nodes: dict[str, str]) -> None:
        """Publish; `nodes` are the publishing nodes' names by topic."""
        self.connections: dict[str, list[socket.socket]] = {topic: [] for topic in nodes}
        self._message = message
        self._names = nodes
        self._listener = socket.create_server((HOST, 0))
        Thread(target=self._accept, daemon=True).start()
        port = self._listener.getsockname()[1]
        self._nodes = {name: Node(name, master, port) for name in dict.fromkeys(nodes.values())}
        for topic, name in nodes.items():
            self._nodes[name].publish(topic, message.type)

    def send(self, topic: str, frames: bytes | bytearray) -> None:
        """Send to all subscribers, and wait for those that do not keep up."""
        for connection in self.connections[topic]:
            connection.sendall(frames)

    def close(self) -> None:
        """Take back the registrations."""
        for node in self._nodes.values():
            node.close()

    def _accept(self) -> None:
        while True:
            sock, _ = self._listener.accept()
            with suppress(OSError, KeyError, RTronError):
                self._welcome(sock)

    def _welcome(self, sock: socket.socket) -> None:
        sock.settimeout(HANDSHAKE_S)
        topic = read_header(sock)["topic"]
        sock.sendall(encode_header(self._header(topic)))
        sock.settimeout(None)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.connections[topic].append(sock)

    def _header(self, topic: str) -> dict[str, str]:
        return {
            "callerid": self._names[topic],
            "latching": "0",
            "md5sum": self._message.md5sum,
            "message_definition": self._message.definition,
            "topic": topic,
            "type": self._message.type,
        }
