"""Nodes that break the rules of ROS 1's slave API."""

import socket
import threading
from contextlib import ExitStack, contextmanager, suppress


@contextmanager
def stranger(answer):
    """Serve on a port of this machine: `answer` gets each connection; yields the node's address."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=_serve, args=(server, answer))
        thread.start()
        try:
            yield f"http://localhost:{server.getsockname()[1]}/"
        finally:
            server.shutdown(socket.SHUT_RDWR)
            thread.join()


def _serve(server, answer):
    with ExitStack() as kept:
        while True:
            try:
                connection, _ = server.accept()
            except OSError:
                return
            kept.enter_context(connection)
            with suppress(OSError):  # the caller may have left
                answer(connection)


def never_answer(connection):
    """Accept and never answer."""


def saying(body):
    """Return an answer to every call: an HTTP response with this XML."""

    def answer(connection):
        connection.recv(1 << 16)
        head = f"HTTP/1.0 200 OK\r\nContent-Length: {len(body)}\r\n\r\n"
        connection.sendall(head.encode() + body)
        connection.shutdown(socket.SHUT_WR)

    return answer


def garbage(connection):
    """Answer with bytes that are no HTTP."""
    connection.recv(1 << 16)
    connection.sendall(bytes(range(256)) * 64)
    connection.shutdown(socket.SHUT_WR)
