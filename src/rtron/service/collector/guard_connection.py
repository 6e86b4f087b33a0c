"""One guard's connection: what it says is handled in order, what it is told is the newest."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from typing import TypeAlias

from fastapi import WebSocket, WebSocketDisconnect
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.close_codes import CloseCode, CloseConnectionError
from rtron.service.collector.data_collector import DataCollector
from rtron.service.collector.event_writer import QueuedBatch
from rtron.service.collector.state_throttle import StateThrottle
from rtron.service.store.event_rows import check_event
from rtron.service.store.events import EventBatch
from rtron.vocabulary import GuardEvent, Settings
from rtron.wire.common.link_protocol import (
    MAX_EVENTS,
    PROTOCOL,
    Applied,
    Events,
    Hello,
    NewSettings,
    StateReport,
    Stored,
    decode_from_guard,
    encode_to_guard,
)

log = logging.getLogger(__name__)

GuardMessage: TypeAlias = Hello | Events | StateReport | Applied


class GuardConnection:
    """A guard that has shown its token; `run` ends when the connection does.

    What is to be sent waits in one place for settings and one for each run: only the newest count,
    so that a guard that does not read costs no memory.
    """

    def __init__(self, collector: DataCollector, socket: WebSocket, robot: str, token: str) -> None:
        self.robot = robot
        self._token = token
        self._collector = collector
        self._socket = socket
        self._loop = asyncio.get_running_loop()
        self._has_outgoing = asyncio.Event()
        self._robot_id = 0
        self._has_hello = self._is_handshake_done = self._has_missed_settings = False
        self._settings = Settings()
        self._has_unsent_settings = False
        self._acknowledgements: dict[str, int] = {}
        self._closing: CloseConnectionError | None = None
        self._state_throttle = StateThrottle(partial(collector.hub.set_state, robot, self))

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way; from any thread."""
        self._call_in_loop(partial(self._set_settings, settings))

    def replace(self) -> None:
        """End the connection: another one of this robot has come; from any thread."""
        reason = f"another guard has connected as {self.robot}"
        self._call_in_loop(partial(self._close, CloseConnectionError(CloseCode.REPLACED, reason)))

    async def run(self) -> None:
        """Talk with the guard until it goes; Closing if it has to."""
        tasks = [
            asyncio.create_task(each)
            for each in (self._receive_messages(), self._send_messages(), self._watch_token())
        ]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            self._state_throttle.stop()
            self._collector.hub.unregister(self.robot, self)
        for task in done:
            task.result()

    async def _receive_messages(self) -> None:
        async for message, size in self._messages():
            if isinstance(message, Hello):
                await self._handle_hello(message)
            elif not self._has_hello:
                raise CloseConnectionError(CloseCode.MALFORMED, "a guard says hello first")
            elif isinstance(message, Events):
                await self._enqueue_events(message.events, size)
            elif isinstance(message, StateReport):
                self._state_throttle.put(message.state, size)
            else:
                await asyncio.to_thread(self._collector.handle_applied, self.robot, message)

    async def _messages(self) -> AsyncIterator[tuple[GuardMessage, int]]:
        timeouts = self._collector.timeouts
        while True:
            timeout_s = timeouts.silence if self._has_hello else timeouts.hello
            try:
                frame = await asyncio.wait_for(self._frame(), timeout_s)
            except asyncio.TimeoutError:
                raise CloseConnectionError(
                    CloseCode.TOO_SLOW, f"nothing was said for {timeout_s:g} s"
                ) from None
            yield decode_from_guard(frame), len(frame)

    async def _frame(self) -> bytes | str:
        received = await self._socket.receive()
        if received["type"] == "websocket.disconnect":
            raise WebSocketDisconnect
        frame: bytes | str = received.get("bytes") or received.get("text") or b""
        return frame

    async def _handle_hello(self, hello: Hello) -> None:
        """Ask what to put in force; once more if that has changed while it was looked up."""
        if self._has_hello:
            raise CloseConnectionError(
                CloseCode.TOO_MUCH, "a guard says hello once on a connection"
            )
        self._has_hello = True
        self._check_hello(hello)
        self._is_handshake_done, self._has_missed_settings = False, True
        if self._collector.hub.register(self.robot, self, dry_run=hello.dry_run):
            self._collector.counters.replaced_connections += 1
            log.warning(
                "%s: its guard has connected twice, the newest connection stays", self.robot
            )
        while self._has_missed_settings:
            self._has_missed_settings = False
            settings = await asyncio.to_thread(self._collector.handle_hello, self.robot, hello)
        self._is_handshake_done, self._settings, self._has_unsent_settings = True, settings, True
        robot_id = await asyncio.to_thread(self._collector.register_robot, self.robot)
        self._robot_id = robot_id or 0
        self._has_outgoing.set()

    def _check_hello(self, hello: Hello) -> None:
        if hello.protocol != PROTOCOL:
            reason = f"this service speaks protocol {PROTOCOL}, not {hello.protocol}"
            raise CloseConnectionError(CloseCode.PROTOCOL, reason)
        if hello.robot not in ("", self.robot):
            raise CloseConnectionError(CloseCode.WRONG_ROBOT, f"the token is for {self.robot}")

    async def _enqueue_events(self, events: Sequence[GuardEvent], size: int) -> None:
        """Hand events on; while there is no place for them, nothing more is read."""
        if len(events) > MAX_EVENTS:
            raise CloseConnectionError(
                CloseCode.TOO_BIG, f"at most {MAX_EVENTS} events in one message"
            )
        if not self._robot_id:
            raise CloseConnectionError(CloseCode.FAILED, "the events could not be stored")
        for event in events:
            check_event(event)
        batch = EventBatch(self._robot_id, self.robot, events)
        await self._collector.event_writer.put(
            QueuedBatch(batch, size, partial(self._handle_stored, events))
        )

    def _handle_stored(self, events: Sequence[GuardEvent], is_stored: bool) -> None:  # noqa: FBT001 - the answer
        if not is_stored:
            self._collector.counters.failed_batches += 1
            self._close(CloseConnectionError(CloseCode.FAILED, "the events could not be stored"))
            return
        for event in events:
            self._acknowledgements[event.run] = max(
                event.number, self._acknowledgements.get(event.run, 0)
            )
        self._has_outgoing.set()

    async def _send_messages(self) -> None:
        while True:
            await self._has_outgoing.wait()
            self._has_outgoing.clear()
            if self._closing:
                raise self._closing
            for message in self._outgoing_messages():
                await self._send(encode_to_guard(message).decode())

    def _outgoing_messages(self) -> Iterator[NewSettings | Stored]:
        if self._has_unsent_settings:
            self._has_unsent_settings = False
            yield NewSettings(settings=self._settings, now=self._collector.clock())
        while self._acknowledgements:
            run, number = self._acknowledgements.popitem()
            yield Stored(run=run, number=number)

    async def _send(self, text: str) -> None:
        sending = self._socket.send_text(text)
        try:
            await asyncio.wait_for(sending, self._collector.timeouts.sending)
        except asyncio.TimeoutError:
            raise CloseConnectionError(CloseCode.TOO_SLOW, "what was sent was not read") from None

    async def _watch_token(self) -> None:
        """End with the token: it may be revoked, or over."""
        while True:
            await asyncio.sleep(self._collector.timeouts.token)
            with suppress(SQLAlchemyError):  # it is away: no reason to leave a guard alone
                robot = await asyncio.to_thread(self._collector.authenticate, self._token)
                if robot != self.robot:
                    raise CloseConnectionError(CloseCode.NO_TOKEN, "the token is revoked, or over")

    def _set_settings(self, settings: Settings) -> None:
        if not self._is_handshake_done:
            self._has_missed_settings = True
        elif settings.revision > self._settings.revision:
            self._settings, self._has_unsent_settings = settings, True
            self._has_outgoing.set()

    def _close(self, closing: CloseConnectionError) -> None:
        self._closing = self._closing or closing
        self._has_outgoing.set()

    def _call_in_loop(self, call: Callable[[], None]) -> None:
        with suppress(RuntimeError):  # the service has ended
            self._loop.call_soon_threadsafe(call)
