"""What is said to a guard: on a descriptor of its own, apart from what is heard.

A guard that was killed is still to be heard to its last word, which waits in the kernel. With one
transport for both, the first word said to it would end the hearing.
"""

import asyncio
import logging
import socket

log = logging.getLogger(__name__)


class LineWriter:
    """Says lines to a connected socket, in their order, until it takes no more."""

    def __init__(self, sock: socket.socket) -> None:
        self._sock = sock.dup()
        self._sock.settimeout(0)
        self._lines: asyncio.Queue[bytes] = asyncio.Queue()
        self._task = asyncio.create_task(self._run())

    def write(self, line: bytes) -> None:
        """Say a line, as soon as those before it are said."""
        self._lines.put_nowait(line + b"\n")

    def close(self) -> None:
        """Say no more."""
        self._task.cancel()
        self._sock.close()

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        try:
            while True:
                await loop.sock_sendall(self._sock, await self._lines.get())
        except OSError as error:
            log.debug("the guard hears no more: %s", error)
