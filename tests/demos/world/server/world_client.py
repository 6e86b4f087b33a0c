"""A world's server in a thread, and clients of it, for the tests."""

import socket
from contextlib import contextmanager
from threading import Thread

from rtron.demos.world.server.loop import WorldServer
from rtron.demos.world.server.protocol import FrameParser, encode_frame
from rtron.demos.world.server.unix_socket import listen_on_unix_socket

KEY = "the key"
SPEED = 8.0
LIMIT = 20.0


class Client:
    """A device of the test's own."""

    def __init__(self, path, role=None, **hello):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(LIMIT)
        self.socket.connect(str(path))
        self._parser = FrameParser()
        self._frames = []
        if role:
            self.send({"hello": role, **hello})
            self.welcome = self.next().head

    def send(self, head):
        self.socket.sendall(encode_frame(head))

    def next(self):
        while not self._frames:
            data = self.socket.recv(1 << 16)
            if not data:
                raise EOFError
            self._frames += self._parser.feed(data)
        return self._frames.pop(0)

    def until(self, condition):
        while not condition(frame := self.next()):
            pass
        return frame

    def is_dropped(self):
        try:
            while True:
                self.next()
        except (EOFError, ConnectionError):
            return True


@contextmanager
def serving(path):
    """Serve a world until the end of the block."""
    with listen_on_unix_socket(path) as listener:
        server = WorldServer(listener, SPEED, KEY)
        thread = Thread(target=server.run, daemon=True)
        thread.start()
        yield path
        server.stop()
        thread.join(LIMIT)
        assert not thread.is_alive()


@contextmanager
def clients(path):
    """Yield what connects clients, which are closed at the end of the block."""
    made = []

    def connect(*arguments, **hello):
        made.append(Client(path, *arguments, **hello))
        return made[-1]

    yield connect
    for each in made:
        each.socket.close()


def truth_when(owner, condition):
    """Return the first truth for which a condition holds."""
    for _ in range(400):
        for truth in owner.poll(LIMIT):
            if condition(truth):
                return truth
    raise AssertionError("it never came true")
