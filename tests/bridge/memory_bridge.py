"""A bridge on loopback whose graph is in memory: real WebSockets, and nodes that tests look at."""

import json
import threading
from concurrent.futures import Future
from contextlib import contextmanager

from bridge_parts import RIGHTS, plan, rights, types
from websockets.sync.client import connect

from rtron.bridge.server.bridge import Bridge
from rtron.guard.core.event_loop import EventLoop

LIMIT_S = 30


class MemoryNode:
    """A client's node in no graph, which writes down what it is asked to do."""

    def __init__(self, listener):
        self.listener = listener
        self.done = []
        self.is_closed = False

    def publish(self, topic, message, *, is_latched):
        self.done.append(("publish", topic, message, is_latched))

    def close(self):
        self.is_closed = True

    def __getattr__(self, name):
        return lambda *what: self.done.append((name, *what))


class MemoryBridge:
    """A bridge in a thread of its own, and clients of the library."""

    def __init__(self, text):
        known = plan(1)
        self.loop = EventLoop()
        self.nodes = {}
        self.opened = []
        self.bridge = Bridge(self.loop, known, rights(text), types(known), self)
        self.port = self.bridge.listen("127.0.0.1", 0)
        self._thread = threading.Thread(target=self.loop.run)
        self._thread.start()

    def open(self, client, listener):
        """See `NodeFactory`."""
        node = self.nodes[client.name] = MemoryNode(listener)
        self.opened.append(node)
        return node

    def close(self):
        """See `NodeFactory`."""

    def in_loop(self, work):
        """Return what `work` gives in the loop's thread."""
        done = Future()

        def run():
            try:
                done.set_result(work())
            except BaseException as error:
                done.set_exception(error)
                raise

        self.loop.post(run)
        return done.result(LIMIT_S)

    def end(self):
        self.in_loop(self.bridge.close)
        self.loop.post(self.loop.stop)
        self._thread.join(LIMIT_S)
        self.loop.close()

    def connect(self, token=None, path="/", **options):
        """Return a WebSocket, signed in with a token if one is given."""
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        headers |= options.pop("headers", {})
        options = {"compression": None, "max_size": 1 << 26} | options
        address = f"ws://127.0.0.1:{self.port}{path}"
        return connect(address, additional_headers=headers, proxy=None, **options)


@contextmanager
def memory_bridge(text=RIGHTS):
    running = MemoryBridge(text)
    try:
        yield running
    finally:
        running.end()


def say(socket, op, **fields):
    socket.send(json.dumps({"op": op, **fields}))


def hear(socket):
    """Return the next frame."""
    return json.loads(socket.recv(LIMIT_S))
