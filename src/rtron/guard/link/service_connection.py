"""The link process's way to the service: events out of the spool, settings in."""

import asyncio
import logging
import random
import ssl
from collections.abc import Callable, Sequence
from itertools import accumulate

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus

from rtron.errors import RTronError
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.spool import Row, Spool
from rtron.wire.common.link_protocol import (
    LONGEST,
    Applied,
    Hello,
    NewSettings,
    State,
    Stored,
    events_bytes,
    guard_bytes,
    to_guard,
)

log = logging.getLogger(__name__)

_BATCH = 500
_BATCH_BYTES = LONGEST // 4
_IN_FLIGHT = 8 * _BATCH
_FIRST_S, _LONGEST_S = 0.1, 10.0
_PATIENCE_S = 10.0
_FORBIDDEN = (401, 403)


class Post:
    """Keeps a connection to the service while there is a guard, or something to deliver."""

    def __init__(
        self,
        options: LinkOptions,
        spool: Spool,
        settings: Callable[[NewSettings], None],
    ) -> None:
        self._options = options
        self._spool = spool
        self._settings = settings
        self._hello: Hello | None = None
        self._to_say: list[State | Applied] = []
        self._news = asyncio.Event()
        self._renewed = asyncio.Event()
        self._warned = ""

    def greet(self, hello: Hello) -> None:
        """Speak for this life of the guard; a connection for another one ends."""
        self._hello = hello
        self._renewed.set()
        self._news.set()

    def leave(self) -> None:
        """Speak for nobody until the next `greet`."""
        self._hello = None
        self._renewed.set()

    def say(self, message: State | Applied) -> None:
        """Pass on what the guard says; of states only the newest waits."""
        if isinstance(message, State):
            self._to_say = [each for each in self._to_say if not isinstance(each, State)]
        self._to_say.append(message)
        self._news.set()

    def has_news(self) -> None:
        """There is something new in the spool."""
        self._news.set()

    async def run(self) -> None:
        """Connect, and again with a growing pause whenever that ends."""
        pause = _FIRST_S
        while True:
            await self._wait_for_guard()
            if await self._connected():
                pause = _FIRST_S
            await asyncio.sleep(pause * (0.5 + random.random()))  # noqa: S311 - no secret
            pause = min(2 * pause, _LONGEST_S)

    async def _wait_for_guard(self) -> None:
        while self._hello is None:
            self._news.clear()
            await self._news.wait()

    async def _connected(self) -> bool:
        """Serve one connection until it ends; tell whether there was one."""
        try:
            async with self._connection() as socket:
                log.info("connected to %s", self._options.service)
                self._warned = ""
                await self._serve(socket)
                return True
        except (OSError, InvalidHandshake, ConnectionClosed, RTronError, TimeoutError) as error:
            self._warn(error)
            return False

    def _connection(self) -> connect:
        secure = self._options.url.startswith("wss:")
        return connect(
            self._options.url,
            additional_headers={"Authorization": f"Bearer {self._options.token()}"},
            ssl=ssl.create_default_context(cafile=self._options.ca) if secure else None,
            max_size=LONGEST,
            open_timeout=_PATIENCE_S,
            ping_interval=_PATIENCE_S,
            ping_timeout=_PATIENCE_S,
            close_timeout=1,
            compression=None,
            proxy=None,
        )

    async def _serve(self, socket: ClientConnection) -> None:
        if self._hello is None:
            raise AssertionError("nobody connects without a guard")
        self._renewed.clear()
        await socket.send(guard_bytes(self._hello), text=True)
        works = {
            asyncio.create_task(self._deliver(socket)),
            asyncio.create_task(self._hear(socket)),
            asyncio.create_task(self._renewed.wait()),
        }
        done, left = await asyncio.wait(works, return_when=asyncio.FIRST_COMPLETED)
        for task in left:
            task.cancel()
        await asyncio.wait(works)
        errors = [error for task in done if (error := task.exception())]
        if errors:
            raise errors[0]

    async def _deliver(self, socket: ClientConnection) -> None:
        """Send what the guard says now, and the spool from its beginning on."""
        position = 0
        while True:
            self._news.clear()
            for message in self._taken():
                await socket.send(guard_bytes(message), text=True)
            rows = _bounded(self._spool.after(position, _BATCH))
            if rows and len(rows) + position - self._first(position) <= _IN_FLIGHT:
                position = rows[-1][0]
                await socket.send(events_bytes(row[3] for row in rows), text=True)
            else:
                await self._news.wait()

    def _first(self, position: int) -> int:
        """Return the position before the oldest event that the service has not confirmed."""
        oldest = self._spool.after(0, 1)
        return min(position, oldest[0][0] - 1) if oldest else position

    def _taken(self) -> list[State | Applied]:
        taken, self._to_say = self._to_say, []
        return taken

    async def _hear(self, socket: ClientConnection) -> None:
        async for frame in socket:
            message = to_guard(frame)
            if isinstance(message, Stored):
                self._spool.forget(message.run, message.number)
                self._news.set()
            else:
                self._settings(message)

    def _warn(self, error: Exception) -> None:
        told = str(error)
        if isinstance(error, InvalidStatus) and error.response.status_code in _FORBIDDEN:
            told = f"the service refuses the token in {self._options.token_file}"
        if told != self._warned:
            self._warned = told
            log.warning("not connected to %s, tried again: %s", self._options.service, told)


def _bounded(rows: Sequence[Row]) -> Sequence[Row]:
    """Return the first of these events, as many as one message may have; one at least."""
    lengths = accumulate(len(body) for *_, body in rows)
    fitting = sum(length <= _BATCH_BYTES for length in lengths)
    return rows[: max(1, fitting)]
