"""Subscribers without a client library: every publisher's connection, to be read as one likes."""

import socket
import sys
from collections.abc import Callable, Sequence
from functools import partial
from threading import Lock

from bench.ros1.messages import Message
from bench.ros1.node import HANDSHAKE_S, Node, read_header
from rtron.errors import RTronError
from rtron.vocabulary import SUPERVISOR_NODE
from rtron.wire.ros1.tcpros import encode_header
from rtron.wire.ros1.xmlrpc import ros_call

Connected = Callable[[str, socket.socket], None]
"""Takes a topic and a connection that its messages come from."""


class Subscribers:
    """Topics of one message type, subscribed by one node.

    The supervisor speaks only in a guard's place: who measures the way through the guard does not
    listen to it.
    """

    def __init__(
        self,
        master: str,
        message: Message,
        name: str,
        topics: Sequence[str],
        connected: Connected,
        *,
        supervised: bool = False,
    ) -> None:
        """`supervised`: listen to the supervisor too."""
        self._ignored = "" if supervised else SUPERVISOR_NODE
        self._message = message
        self._connected = connected
        self._known: set[tuple[str, str]] = set()
        self._lock = Lock()
        self._node = Node(name, master)
        for topic in topics:
            self._node.subscribe(topic, message.type, partial(self._update, topic))

    def close(self) -> None:
        """Take back the registrations."""
        self._node.close()

    def _update(self, topic: str, uris: Sequence[str]) -> None:
        with self._lock:
            fresh = [uri for uri in uris if (topic, uri) not in self._known]
            self._known.update((topic, uri) for uri in fresh)
        for uri in fresh:
            self._try_connect(topic, uri)

    def _try_connect(self, topic: str, uri: str) -> None:
        try:
            node, sock = self._connect(topic, uri)
        except (OSError, RTronError) as error:
            print(f"{topic} from {uri}: {error}", file=sys.stderr)
            return
        if node == self._ignored:
            sock.close()
        else:
            self._connected(topic, sock)

    def _connect(self, topic: str, uri: str) -> tuple[str, socket.socket]:
        """Return who publishes, and the connection to it."""
        protocols = [["TCPROS"]]
        address = ros_call(
            uri, "requestTopic", self._node.name, topic, protocols, timeout=HANDSHAKE_S
        )
        sock = socket.create_connection((address[1], address[2]), HANDSHAKE_S)
        sock.sendall(encode_header(self._header(topic)))
        answer = read_header(sock)
        if "error" in answer:
            raise ConnectionError(answer["error"])
        sock.settimeout(0)
        return answer.get("callerid", ""), sock

    def _header(self, topic: str) -> dict[str, str]:
        return {
            "callerid": self._node.name,
            "md5sum": self._message.md5sum,
            "message_definition": self._message.definition,
            "tcp_nodelay": "1",
            "topic": topic,
            "type": self._message.type,
        }
