"""uvicorn in a thread of the tests: it begins and ends at once, where nobody is connected."""

import asyncio
import socket
from contextlib import contextmanager
from threading import Event, Thread

import uvicorn
from websockets.protocol import State

LIMIT_S = 120
_LOOK_S = 0.01
_TURNS = 4
"""In so many the loop makes a connection of what it has accepted; one left out stays open."""


class PromptServer(uvicorn.Server):
    """A server that tells when it listens and is told when to end; uvicorn's looks each 0.1 s."""

    def __init__(self, config):
        super().__init__(config)
        self._listens = Event()
        self._loop = self._end = None

    async def startup(self, sockets=None):
        """Begin to listen, and say so."""
        await super().startup(sockets)
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        self._listens.set()

    async def main_loop(self):
        """Serve until `stop`."""
        await self.on_tick(0)
        await self._end.wait()

    async def shutdown(self, sockets=None):
        """End; where somebody is connected, as uvicorn does, which waits for them."""
        for each in (*self.servers, *sockets):
            each.close()
        for _ in range(_TURNS):  # the loop sees who has just come or gone
            await asyncio.sleep(0)
        while any(map(_is_closing, self.server_state.connections)):  # noqa: ASYNC110 - no event
            await asyncio.sleep(_LOOK_S)
        if self.server_state.connections or self.server_state.tasks:
            await super().shutdown(sockets)
            return
        await self.lifespan.shutdown()

    def wait_until_listening(self):
        """Wait until it listens."""
        assert self._listens.wait(LIMIT_S), "the server does not listen"

    def stop(self):
        """Let it end."""
        self._loop.call_soon_threadsafe(self._end.set)


def _is_closing(connection):
    """Tell whether a WebSocket says goodbye: uvicorn would fail where it says so once more."""
    return getattr(getattr(connection, "conn", None), "state", None) is State.CLOSING


def bound_socket(port=0):
    """Return a socket on a port that others of ours may have too, or on a free one.

    asyncio sends at once only on one that says it is TCP's.
    """
    bound = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    bound.bind(("127.0.0.1", port))
    return bound


@contextmanager
def serve_app(app, options, limited=lambda listening: listening, port=0):
    """Serve an app with options of uvicorn's until the end of the block; give its port."""
    bound = bound_socket(port)
    bound.listen()
    listening = limited(bound)
    port = listening.getsockname()[1]
    server = PromptServer(uvicorn.Config(app, **{**options, "port": port}))
    thread = Thread(target=server.run, kwargs={"sockets": [listening]}, daemon=True)
    thread.start()
    server.wait_until_listening()
    try:
        yield port
    finally:
        server.stop()
        thread.join(LIMIT_S)
        assert not thread.is_alive()
