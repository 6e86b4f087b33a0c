"""A ROS 1 node with nothing but what a benchmark needs: far lighter than rospy."""

import os
import socket
from collections.abc import Callable, Sequence
from contextlib import suppress
from socketserver import ThreadingMixIn
from threading import Thread
from typing import Any
from xmlrpc.server import SimpleXMLRPCServer

from rtron.errors import RTronError
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros1.tcpros import LENGTH, MAX_HEADER, decode_header, frame_length
from rtron.wire.ros1.xmlrpc import ros_call

HOST = "127.0.0.1"
_TIMEOUT_S = 10.0
_GUARD_TIMEOUT_S = 2.0
Answer = list[Any]
Updated = Callable[[Sequence[str]], None]


class _Server(ThreadingMixIn, SimpleXMLRPCServer):
    daemon_threads = True


class Node:
    """A name at the master and a slave API behind it; `port` is where its TCPROS is served."""

    def __init__(self, name: str, master: str, port: int = 0) -> None:
        self.name = name
        self._master = master
        self._port = port
        self._updated: dict[str, Updated] = {}
        self._undo: list[tuple[str, str]] = []
        self._server = _Server((HOST, 0), logRequests=False, allow_none=True)
        self.uri = f"http://{HOST}:{self._server.server_address[1]}/"
        self._offer()
        Thread(target=self._server.serve_forever, daemon=True).start()

    def publish(self, topic: str, type: str) -> None:
        """Register as a publisher of `topic`."""
        self.call("registerPublisher", topic, type, self.uri)
        self._undo.append(("unregisterPublisher", topic))

    def subscribe(self, topic: str, type: str, updated: Updated) -> None:
        """Register as a subscriber of `topic`; `updated` learns every list of publishers."""
        self._updated[topic] = updated
        self._undo.append(("unregisterSubscriber", topic))
        updated(self.call("registerSubscriber", topic, type, self.uri))

    def call(self, method: str, *params: object) -> Any:  # noqa: ANN401 - any XML-RPC value
        """Call the master under this node's name."""
        return ros_call(self._master, method, self.name, *params, timeout=_TIMEOUT_S)

    def close(self) -> None:
        """Take back every registration."""
        for method, topic in self._undo:
            with suppress(RTronError):
                self.call(method, topic, self.uri)

    def _offer(self) -> None:
        answers: dict[str, Any] = {
            "getPid": os.getpid(),
            "getMasterUri": self._master,
            "getBusInfo": [],
            "getBusStats": [[], [], []],
            "getPublications": [],
            "getSubscriptions": [],
            "paramUpdate": 0,
            "shutdown": 0,
            "requestTopic": ["TCPROS", HOST, self._port],
        }
        for method, value in answers.items():
            self._server.register_function(_always(value), method)
        self._server.register_function(self._publisher_update, "publisherUpdate")

    def _publisher_update(self, *params: Any) -> Answer:  # noqa: ANN401 - as called by the master
        _, topic, publishers = params
        self._updated[topic](publishers)
        return [1, "", 0]


def _always(value: object) -> Callable[..., Answer]:
    return lambda *_: [1, "", value]


HANDSHAKE_S = 10.0


def read_header(sock: socket.socket) -> dict[str, str]:
    """Read one connection header."""
    length = frame_length(_receive_exactly(sock, LENGTH.size), MAX_HEADER)
    return decode_header(_receive_exactly(sock, length))


def _receive_exactly(sock: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        more = sock.recv(size - len(data))
        if not more:
            raise ConnectionError("closed during the handshake")
        data += more
    return data


def guard_pid(master: str) -> int:
    """Return the guard's process, whose parent is the supervisor; 0 while it does not answer."""
    with suppress(RTronError):
        uri = ros_call(master, "lookupNode", "/bench", GUARD_NODE, timeout=_GUARD_TIMEOUT_S)
        return int(ros_call(uri, "getPid", "/bench", timeout=_GUARD_TIMEOUT_S))
    return 0
