"""One guard's connection: what it says is handled in order, what it is told is the newest."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from typing import TypeAlias

from fastapi import WebSocket, WebSocketDisconnect
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.close_codes import CloseCode, Closing
from rtron.service.collector.data_collector import Collector
from rtron.service.collector.event_writer import Waiting
from rtron.service.collector.state_throttle import States
from rtron.service.store.event_rows import check
from rtron.service.store.events import Batch
from rtron.vocabulary import GuardEvent, Settings
from rtron.wire.common.link_protocol import (
    MOST_EVENTS,
    PROTOCOL,
    Applied,
    Events,
    Hello,
    NewSettings,
    State,
    Stored,
    from_guard,
    service_bytes,
)

log = logging.getLogger(__name__)

Message: TypeAlias = Hello | Events | State | Applied


class Connection:
    """A guard that has shown its token; `run` ends when the connection does.

    What is to be sent waits in one place for settings and one for each run: only the newest count,
    so that a guard that does not read costs no memory.
    """

    def __init__(self, collector: Collector, socket: WebSocket, robot: str, token: str) -> None:
        self.robot = robot
        self._token = token
        self._collector = collector
        self._socket = socket
        self._loop = asyncio.get_running_loop()
        self._wake = asyncio.Event()
        self._robot_id = 0
        self._has_said_hello = self._greeted = self._missed = False
        self._settings = Settings()
        self._due = False
        self._stored: dict[str, int] = {}
        self._closing: Closing | None = None
        self._states = States(partial(collector.hub.update, robot, self))

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way; from any thread."""
        self._soon(partial(self._push, settings))

    def replace(self) -> None:
        """End the connection: another one of this robot has come; from any thread."""
        reason = f"another guard has connected as {self.robot}"
        self._soon(partial(self._end, Closing(CloseCode.REPLACED, reason)))

    async def run(self) -> None:
        """Talk with the guard until it goes; Closing if it has to."""
        tasks = [asyncio.create_task(each) for each in (self._hear(), self._say(), self._watch())]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self._states.stop()
            self._collector.hub.leave(self.robot, self)
        for task in done:
            task.result()

    async def _hear(self) -> None:
        async for message, size in self._messages():
            if isinstance(message, Hello):
                await self._greet(message)
            elif not self._has_said_hello:
                raise Closing(CloseCode.MALFORMED, "a guard says hello first")
            elif isinstance(message, Events):
                await self._take(message.events, size)
            elif isinstance(message, State):
                self._states.take(message.state, size)
            else:
                await asyncio.to_thread(self._collector.answered, self.robot, message)

    async def _messages(self) -> AsyncIterator[tuple[Message, int]]:
        patience = self._collector.patience
        while True:
            wait = patience.silence if self._has_said_hello else patience.hello
            try:
                frame = await asyncio.wait_for(self._frame(), wait)
            except asyncio.TimeoutError:
                raise Closing(CloseCode.TOO_SLOW, f"nothing was said for {wait:g} s") from None
            yield from_guard(frame), len(frame)

    async def _frame(self) -> bytes | str:
        received = await self._socket.receive()
        if received["type"] == "websocket.disconnect":
            raise WebSocketDisconnect
        frame: bytes | str = received.get("bytes") or received.get("text") or b""
        return frame

    async def _greet(self, hello: Hello) -> None:
        """Ask what to put in force; once more if that has changed while it was looked up."""
        if self._has_said_hello:
            raise Closing(CloseCode.TOO_MUCH, "a guard says hello once on a connection")
        self._has_said_hello = True
        self._check(hello)
        self._greeted, self._missed = False, True
        if self._collector.hub.join(self.robot, self, dry_run=hello.dry_run):
            self._collector.tally.replaced += 1
            log.warning(
                "%s: its guard has connected twice, the newest connection stays", self.robot
            )
        while self._missed:
            self._missed = False
            settings = await asyncio.to_thread(self._collector.greet, self.robot, hello)
        self._greeted, self._settings, self._due = True, settings, True
        found = await asyncio.to_thread(self._collector.meet, self.robot)
        self._robot_id = found or 0
        self._wake.set()

    def _check(self, hello: Hello) -> None:
        if hello.protocol != PROTOCOL:
            reason = f"this service speaks protocol {PROTOCOL}, not {hello.protocol}"
            raise Closing(CloseCode.PROTOCOL, reason)
        if hello.robot not in ("", self.robot):
            raise Closing(CloseCode.WRONG_ROBOT, f"the token is for {self.robot}")

    async def _take(self, events: Sequence[GuardEvent], size: int) -> None:
        """Hand events on; while there is no place for them, nothing more is read."""
        if len(events) > MOST_EVENTS:
            raise Closing(CloseCode.TOO_BIG, f"at most {MOST_EVENTS} events in one message")
        if not self._robot_id:
            raise Closing(CloseCode.FAILED, "the events could not be stored")
        for event in events:
            check(event)
        batch = Batch(self._robot_id, self.robot, events)
        await self._collector.intake.put(Waiting(batch, size, partial(self._done, events)))

    def _done(self, events: Sequence[GuardEvent], stored: bool) -> None:  # noqa: FBT001 - the answer
        if not stored:
            self._collector.tally.failures += 1
            self._end(Closing(CloseCode.FAILED, "the events could not be stored"))
            return
        for event in events:
            self._stored[event.run] = max(event.number, self._stored.get(event.run, 0))
        self._wake.set()

    async def _say(self) -> None:
        while True:
            await self._wake.wait()
            self._wake.clear()
            if self._closing:
                raise self._closing
            for message in self._to_say():
                await self._send(service_bytes(message).decode())

    def _to_say(self) -> Iterator[NewSettings | Stored]:
        if self._due:
            self._due = False
            yield NewSettings(settings=self._settings, now=self._collector.clock())
        while self._stored:
            run, number = self._stored.popitem()
            yield Stored(run=run, number=number)

    async def _send(self, text: str) -> None:
        sending = self._socket.send_text(text)
        try:
            await asyncio.wait_for(sending, self._collector.patience.sending)
        except asyncio.TimeoutError:
            raise Closing(CloseCode.TOO_SLOW, "what was sent was not read") from None

    async def _watch(self) -> None:
        """End with the token: it may be revoked, or over."""
        while True:
            await asyncio.sleep(self._collector.patience.token)
            with suppress(SQLAlchemyError):  # it is away: no reason to leave a guard alone
                robot = await asyncio.to_thread(self._collector.authenticate, self._token)
                if robot != self.robot:
                    raise Closing(CloseCode.NO_TOKEN, "the token is revoked, or over")

    def _push(self, settings: Settings) -> None:
        if not self._greeted:
            self._missed = True
        elif settings.revision > self._settings.revision:
            self._settings, self._due = settings, True
            self._wake.set()

    def _end(self, closing: Closing) -> None:
        self._closing = self._closing or closing
        self._wake.set()

    def _soon(self, call: Callable[[], None]) -> None:
        with suppress(RuntimeError):  # the service has ended
            self._loop.call_soon_threadsafe(call)
