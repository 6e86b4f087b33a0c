"""A proxy in this process, before a small XML-RPC server in the place of rosmaster; and nodes."""

import socket
import threading
from contextlib import ExitStack, contextmanager
from xmlrpc.server import SimpleXMLRPCServer

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.master_proxy.server import MasterProxy
from rtron.guard.transport.ros1.tcp_server import TcpServer


class Master:
    """Notes what it is asked, and answers with it; `lookups` are the nodes that it knows."""

    def __init__(self):
        self.asked = []
        self.lookups = {}

    def _dispatch(self, method, params):
        if params[:1] != ("/rtron_master",):  # that is the proxy itself
            self.asked.append((method, params))
        if method == "system.multicall":
            return [[self._dispatch(c["methodName"], tuple(c["params"]))] for c in params[0]]
        if method == "lookupNode":
            uri = self.lookups.get(params[1])
            return [1, "", uri] if uri else [-1, "unknown node", ""]
        return [1, method, list(params)]


class Slave:
    """A node's slave API with one method."""

    def __init__(self, pid):
        self.pid = pid

    def _dispatch(self, method, params):
        return [1, "", self.pid]


@contextmanager
def serving(instance):
    """Serve an object's methods; yields the address."""
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True) as server:
        server.register_instance(instance)
        thread = threading.Thread(target=server.serve_forever, args=(0.02,))
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}/"
        finally:
            server.shutdown()
            thread.join()


@contextmanager
def running(loop):
    """Run a loop in a thread."""
    thread = threading.Thread(target=loop.run)
    thread.start()
    try:
        yield
    finally:
        loop.post(loop.stop)
        thread.join()


@contextmanager
def running_proxy(topics, private):
    """Put a proxy before the master at `private`; yields the proxy's address."""
    with ExitStack() as stack:
        loop = EventLoop()
        stack.callback(loop.close)
        proxy = MasterProxy(loop, topics, private, "http://public:11311/")
        server = TcpServer(loop, "127.0.0.1", proxy.accept)
        with running(loop):
            yield f"http://127.0.0.1:{server.port}/"
        proxy.close()
        server.close()


def raw(uri, data, *, limit_s=10, shut=True):
    """Send bytes; return all that comes back until the other side closes."""
    port = int(uri.rstrip("/").rpartition(":")[2])
    with socket.create_connection(("127.0.0.1", port), limit_s) as sock:
        sock.sendall(data)
        if shut:
            sock.shutdown(socket.SHUT_WR)
        parts = []
        while part := sock.recv(1 << 16):
            parts.append(part)
    return b"".join(parts)


def http_post(body, more=""):
    """Return an HTTP request with a body."""
    head = f"POST /RPC2 HTTP/1.1\r\nHost: x\r\nContent-Length: {len(body)}\r\n{more}\r\n"
    return head.encode() + body
