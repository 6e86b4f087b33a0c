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
    MAX_MESSAGE_BYTES,
    Applied,
    Hello,
    NewSettings,
    StateReport,
    Stored,
    decode_to_guard,
    encode_events,
    encode_from_guard,
)

log = logging.getLogger(__name__)

_BATCH = 500
_BATCH_BYTES = MAX_MESSAGE_BYTES // 4
_IN_FLIGHT = 8 * _BATCH
_MIN_PAUSE_S, _MAX_PAUSE_S = 0.1, 10.0
_TIMEOUT_S = 10.0
_FORBIDDEN = (401, 403)


class ServiceConnection:
    """Keeps a connection to the service while there is a guard, or something to deliver."""

    def __init__(
        self,
        options: LinkOptions,
        spool: Spool,
        on_settings: Callable[[NewSettings], None],
    ) -> None:
        self._options = options
        self._spool = spool
        self._on_settings = on_settings
        self._hello: Hello | None = None
        self._outbox: list[StateReport | Applied] = []
        self._wake_event = asyncio.Event()
        self._hello_changed = asyncio.Event()
        self._last_warning = ""

    def announce(self, hello: Hello) -> None:
        """Speak for this life of the guard; a connection for another one ends."""
        self._hello = hello
        self._hello_changed.set()
        self._wake_event.set()

    def withdraw(self) -> None:
        """Speak for nobody until the next `announce`."""
        self._hello = None
        self._hello_changed.set()

    def queue_message(self, message: StateReport | Applied) -> None:
        """Pass on what the guard says; of states only the newest waits."""
        if isinstance(message, StateReport):
            self._outbox = [each for each in self._outbox if not isinstance(each, StateReport)]
        self._outbox.append(message)
        self._wake_event.set()

    def wake(self) -> None:
        """There is something new in the spool."""
        self._wake_event.set()

    async def run(self) -> None:
        """Connect, and again with a growing pause whenever that ends."""
        pause = _MIN_PAUSE_S
        while True:
            await self._wait_for_guard()
            if await self._serve_once():
                pause = _MIN_PAUSE_S
            await asyncio.sleep(pause * (0.5 + random.random()))  # noqa: S311 - no secret
            pause = min(2 * pause, _MAX_PAUSE_S)

    async def _wait_for_guard(self) -> None:
        while self._hello is None:
            self._wake_event.clear()
            await self._wake_event.wait()

    async def _serve_once(self) -> bool:
        """Serve one connection until it ends; tell whether there was one."""
        try:
            async with self._connect() as socket:
                log.info("connected to %s", self._options.service)
                self._last_warning = ""
                await self._serve(socket)
                return True
        except (OSError, InvalidHandshake, ConnectionClosed, RTronError, TimeoutError) as error:
            self._warn(error)
            return False

    def _connect(self) -> connect:
        secure = self._options.url.startswith("wss:")
        return connect(
            self._options.url,
            additional_headers={"Authorization": f"Bearer {self._options.token()}"},
            ssl=ssl.create_default_context(cafile=self._options.ca) if secure else None,
            max_size=MAX_MESSAGE_BYTES,
            open_timeout=_TIMEOUT_S,
            ping_interval=_TIMEOUT_S,
            ping_timeout=_TIMEOUT_S,
            close_timeout=1,
            compression=None,
            proxy=None,
        )

    async def _serve(self, socket: ClientConnection) -> None:
        if self._hello is None:
            raise AssertionError("nobody connects without a guard")
        self._hello_changed.clear()
        await socket.send(encode_from_guard(self._hello), text=True)
        works = [
            asyncio.create_task(self._deliver(socket)),
            asyncio.create_task(self._receive(socket)),
            asyncio.create_task(self._hello_changed.wait()),
        ]
        try:
            await asyncio.wait(works, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in works:
                task.cancel()
            results = await asyncio.gather(*works, return_exceptions=True)
        for error in results:
            if isinstance(error, Exception):
                raise error

    async def _deliver(self, socket: ClientConnection) -> None:
        """Send what the guard says now, and the spool from its beginning on."""
        position = 0
        while True:
            self._wake_event.clear()
            for message in self._take_outbox():
                await socket.send(encode_from_guard(message), text=True)
            rows = _bounded(self._spool.events_after(position, _BATCH))
            if rows and len(rows) + position - self._acknowledged_position(position) <= _IN_FLIGHT:
                position = rows[-1][0]
                await socket.send(encode_events(row[3] for row in rows), text=True)
            else:
                await self._wake_event.wait()

    def _acknowledged_position(self, position: int) -> int:
        """Return the position before the oldest event that the service has not confirmed."""
        oldest = self._spool.events_after(0, 1)
        return min(position, oldest[0][0] - 1) if oldest else position

    def _take_outbox(self) -> list[StateReport | Applied]:
        taken, self._outbox = self._outbox, []
        return taken

    async def _receive(self, socket: ClientConnection) -> None:
        async for frame in socket:
            message = decode_to_guard(frame)
            if isinstance(message, Stored):
                self._spool.forget(message.run, message.number)
                self._wake_event.set()
            else:
                self._on_settings(message)

    def _warn(self, error: Exception) -> None:
        message = str(error)
        if isinstance(error, InvalidStatus) and error.response.status_code in _FORBIDDEN:
            message = f"the service refuses the token in {self._options.token_file}"
        if message != self._last_warning:
            self._last_warning = message
            log.warning("not connected to %s, tried again: %s", self._options.service, message)


def _bounded(rows: Sequence[Row]) -> Sequence[Row]:
    """Return the first of these events, as many as one message may have; one at least."""
    lengths = accumulate(len(body) for *_, body in rows)
    fitting = sum(length <= _BATCH_BYTES for length in lengths)
    return rows[: max(1, fitting)]
