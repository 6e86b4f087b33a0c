"""A transport of the guard and nodes outside the guard, with one interface for each middleware.

A `TransportWorld` has `transport`, `publisher` and `listener` for outside nodes, `shows`, which
tells whether the graph has two nodes, and `until`, which runs the guard until a condition holds.
"""

import socket
import threading
import time
from contextlib import suppress

from harness import LIMIT_S, WaitLimit
from raw_ros1 import RawPublisher, RawSubscriber

from rtron.errors import RTronError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.report_messages import string_message
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.messages.common.encoding import Encoding
from rtron.wire.ros1.xmlrpc import ros_call

STEP_S = 0.02


class TransportWorld:
    """What the worlds have in common; `encoding` is that of their messages.

    Of one topic, `most_waiting` messages wait for a guard that is busy, where they are counted.
    """

    encoding = Encoding.ROS1
    most_waiting = 1000

    def __enter__(self):
        return self

    def info(self, type="std_msgs/String"):
        return standard_info(type, self.encoding)

    def text(self, text):
        return string_message(self.encoding, str(text))

    def let_arrive(self, publisher):
        """Wait until all that a publisher said is where the guard will find it."""


class InMemory(TransportWorld):
    """The memory, as ROS 2 would be encoded in it."""

    encoding = Encoding.CDR

    def __init__(self):
        self.transport = MemoryTransport(self.encoding)
        self.transport.unreachable.add("/nobody")
        self._coming = []

    def __exit__(self, *_):
        pass

    def publisher(self, node, topic, type="std_msgs/String", *, latched=False):
        peer = Peer(node, self.info(type), latched)
        self._coming.append(MemoryPublisher(self.transport, topic, peer))
        return self._coming[-1]

    def listener(self, node, topic, *, latched=False):
        del node, latched
        return self.transport.listen(topic)

    def shows(self, publisher, subscriber, topic):
        del publisher, subscriber
        return topic in self.transport.outputs

    def until(self, condition):
        while self._coming:
            self._coming.pop(0).connect()
        for _ in range(10_000):
            if condition():
                return
            self.transport.advance(1_000_000)
        raise AssertionError("it did not come")


class MemoryPublisher:
    """Is connected to those who have subscribed by then when the test first waits."""

    def __init__(self, transport, topic, peer):
        self._transport, self._topic, self._peer = transport, topic, peer
        self._last = None
        self._say = self._keep

    def say(self, message):
        self._say(message)

    def connect(self):
        self._say = self._transport.publisher(self._topic, self._peer)
        if self._last is not None:
            self._say(self._last)

    def leave(self):
        self._transport.leave(self._topic, self._peer)

    def _keep(self, message):
        if self._peer.latching:
            self._last = message


class RosWorld(TransportWorld):
    """A transport on the loop, which only works while the test waits."""

    def __init__(self):
        self.loop = EventLoop()

    def until(self, condition):
        limit = WaitLimit()
        while not condition():
            limit.check()
            self.loop.step(STEP_S)
            self.serve()

    def serve(self):
        """Let the outside nodes work."""

    def end(self):
        """Close what others still hold open: the master keeps its connections for its next call."""
        for each in list(self.loop._handlers.values()):
            self.loop.forget(each.sock)
        self.loop.close()


class OnRos1(RosWorld):
    """A real master; the outside nodes speak by hand."""

    def __init__(self, ros1):
        super().__init__()
        self._master = ros1
        self.transport = Ros1Transport(self.loop, ros1.uri, "localhost")
        self._publishers = []
        self._listeners = []

    def __exit__(self, *_):
        for each in self._publishers:
            each.leave()
        for each in self._listeners:
            each.close()
        self.transport.close()
        self.end()

    def publisher(self, node, topic, type="std_msgs/String", *, latched=False):
        info = self.info(type)
        header = {"type": info.type, "md5sum": info.md5sum, "message_definition": info.definition}
        header["latching"] = str(int(latched))
        self._publishers.append(Ros1Publisher(self._master.uri, node, topic, header))
        return self._publishers[-1]

    def listener(self, node, topic, *, latched=False):
        del latched
        listener = Ros1Listener(self._master.uri, node, topic, self.info())
        self._listeners.append(listener)
        return listener.heard

    def shows(self, publisher, subscriber, topic):
        """Tell whether the master knows both; without waiting for a node of ours to answer."""
        found = self._master.publishers(topic), self._master.subscribers(topic)
        return publisher in found[0] and subscriber in found[1]


class Ros1Publisher:
    """Says what the test wants; one that latches says its last word to who connects later."""

    def __init__(self, master, node, topic, header):
        self._raw = RawPublisher(master, node, topic, **header)
        self._raw.connections = LatchedConnections()
        self._latching = header["latching"] == "1"
        self._is_here = True

    def say(self, message):
        if self._latching:
            self._raw.connections.last = message
        self._raw.send(message)

    def leave(self):
        if self._is_here:
            self._is_here = False
            self._raw.__exit__()


class LatchedConnections(list):
    """Connections, each of which is told the last word when it is new."""

    last = b""

    def append(self, connection):
        connection.sendall(self.last)
        super().append(connection)


class Ros1Listener:
    """Reads all that a publisher of the guard sends; in a thread, since the guard must answer."""

    def __init__(self, master, node, topic, info):
        self.heard = []
        self._master, self._node, self._topic, self._info = master, node, topic, info
        self._socket = None
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self):
        if self._socket is not None:
            with suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)
        self._thread.join(LIMIT_S)

    def _listen(self):
        with RawSubscriber(self._port()) as subscriber:
            self._socket = subscriber.socket
            kind = {"type": self._info.type, "md5sum": self._info.md5sum}
            subscriber.subscribe(self._topic, callerid=self._node, **kind)
            with suppress(OSError):
                while True:
                    self.heard.append(subscriber.frame())

    def _port(self):
        """Return where the topic's publisher is, once it is there."""
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            with suppress(RTronError, StopIteration):
                state = ros_call(self._master, "getSystemState", "/test", timeout=LIMIT_S)
                nodes = next(nodes for topic, nodes in state[0] if topic == self._topic)
                uri = ros_call(self._master, "lookupNode", "/test", nodes[0], timeout=LIMIT_S)
                asked = (self._node, self._topic, [["TCPROS"]])
                return ros_call(uri, "requestTopic", *asked, timeout=LIMIT_S)[2]
        raise AssertionError(f"nobody publishes {self._topic}")
