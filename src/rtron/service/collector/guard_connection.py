"""One guard's connection: what it says is handled in order, what it is told is the newest."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, TypeAlias

from anyio import fail_after
from fastapi import WebSocket, WebSocketDisconnect

from rtron.service.collector.close_codes import CloseCode, CloseConnectionError
from rtron.service.collector.command_exchange import CommandExchange, understood_commands
from rtron.service.collector.data_collector import DataCollector
from rtron.service.collector.event_writer import EventReceipts, QueuedBatch
from rtron.service.collector.heads_check import Documents
from rtron.service.collector.state_throttle import DeltaBase, StateThrottle
from rtron.service.store.events import EventBatch, check_event
from rtron.vocabulary import Alarm, GuardEvent, GuardState, Settings
from rtron.wire.common.incident_report import IncidentReport
from rtron.wire.common.link_protocol import (
    MAX_EVENTS,
    PROTOCOL,
    Applied,
    AuditHeads,
    CommandResponse,
    Events,
    Hello,
    IncidentSaved,
    IncidentStored,
    NewSettings,
    PersonCommand,
    PlanDocument,
    PlanRequest,
    RenewedToken,
    RenewedTokenStored,
    StateDelta,
    StateReport,
    ToGuard,
    decode_from_guard,
    encode_to_guard,
)

log = logging.getLogger(__name__)

GuardMessage: TypeAlias = (
    Hello
    | Events
    | StateReport
    | StateDelta
    | Applied
    | CommandResponse
    | IncidentSaved
    | PlanRequest
    | RenewedTokenStored
)
MIN_INCIDENT_INTERVAL_S = 0.5
"""So long a link waits at least before the next report of an incident; ours waits 2 s."""


class GuardConnection:
    """A guard that has shown its token; `run` ends when the connection does.

    What is to be sent waits in one place for settings and one for each run: only the newest count,
    so that a guard that does not read costs no memory.
    """

    def __init__(self, collector: DataCollector, socket: WebSocket, robot: str, token: str) -> None:
        self.robot = robot
        self._token = token
        self._next_token = ""
        self._has_unsent_token = False
        self._collector = collector
        self._socket = socket
        self._loop = asyncio.get_running_loop()
        self._has_outgoing = asyncio.Event()
        self._last_received, self._is_waiting = self._loop.time(), True
        self._silence: asyncio.TimerHandle
        self._delta_base = DeltaBase()
        self._robot_id = 0
        self._has_hello = self._is_handshake_done = self._has_missed_settings = False
        self._settings = Settings()
        self._has_unsent_settings = self._takes_heads = False
        self._unsent_heads: dict[str, Any] | None = None
        self._unsent_plan: str | None = None
        self._receipts, self._takes_refusals = EventReceipts(), False
        self._closing: CloseConnectionError | None = None
        self._commands = CommandExchange()
        self._log_alarms: tuple[Alarm, ...] = ()
        self._checking: asyncio.Task[None] | None = None
        self._state_throttle = StateThrottle(self._set_state)
        self._stored_incident, self._incident_at = "", -MIN_INCIDENT_INTERVAL_S

    def push(self, settings: Settings) -> None:
        """Send settings, unless newer ones are on their way; from any thread."""
        self._call_in_loop(partial(self._set_settings, settings))

    def send_command(self, command: PersonCommand) -> Future[CommandResponse]:
        """Send a command of a person, from any thread; return what will have the answer."""
        response: Future[CommandResponse] = Future()
        self._call_in_loop(partial(self._add_command, command, response))
        return response

    def send_heads(self, document: Mapping[str, Any]) -> None:
        """Send signed heads of the audit log, if the guard keeps them; from any thread."""
        self._call_in_loop(partial(self._set_heads, document))

    def replace(self) -> None:
        """End the connection: another one of this robot has come; from any thread."""
        reason = f"another guard has connected as {self.robot}"
        self._call_in_loop(partial(self._close, CloseConnectionError(CloseCode.REPLACED, reason)))

    def leave(self) -> None:
        """End the connection, since this replica knows nothing new; from any thread."""
        reason = "the service is cut off from its database, connect again"
        self._call_in_loop(partial(self._close, CloseConnectionError(CloseCode.GOING_AWAY, reason)))

    async def run(self) -> None:
        """Talk with the guard until it goes; Closing if it has to."""
        tasks = [
            asyncio.create_task(each) for each in (self._receive_messages(), self._send_messages())
        ]
        watch = self._collector.token_watch
        watch.add(self, self._token, self._end_with_token)
        self._watch_silence()
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            watch.remove(self)
            if self._collector.token_renewal:
                self._collector.token_renewal.remove(self)
            self._silence.cancel()
            if self._checking:
                self._checking.cancel()
            self._state_throttle.stop()
            self._commands.close()
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
            elif isinstance(message, StateReport | StateDelta):
                self._state_throttle.put(self._delta_base.take(message, size), size)
            elif isinstance(message, CommandResponse):
                self._commands.answer(message)
            elif isinstance(message, RenewedTokenStored):
                await self._use_next_token()
            elif isinstance(message, IncidentSaved):
                await self._store_incident(message.report)
            elif isinstance(message, PlanRequest):
                await self._find_plan(message.digest)
            else:
                await self._loop.run_in_executor(
                    self._collector.threads.answers,
                    self._collector.handle_applied,
                    self.robot,
                    message,
                )

    async def _messages(self) -> AsyncIterator[tuple[GuardMessage, int]]:
        while True:
            frame = await self._frame()
            self._last_received, self._is_waiting = self._loop.time(), False
            yield decode_from_guard(frame), len(frame)
            self._last_received, self._is_waiting = self._loop.time(), True

    def _watch_silence(self) -> None:
        """End the connection of a guard that says nothing; one timer, not one for each message."""
        timeouts = self._collector.timeouts
        timeout_s = timeouts.silence if self._has_hello else timeouts.hello
        silent_s = self._loop.time() - self._last_received if self._is_waiting else 0.0
        if silent_s >= timeout_s:
            reason = f"nothing was said for {timeout_s:g} s"
            self._close(CloseConnectionError(CloseCode.TOO_SLOW, reason))
        self._silence = self._loop.call_later(max(timeout_s - silent_s, 0.1), self._watch_silence)

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
        self._silence.cancel()
        self._watch_silence()
        self._check_hello(hello)
        self._takes_heads, self._takes_refusals = hello.takes_audit_heads, hello.takes_refusals
        self._commands.understood = understood_commands(hello)
        self._is_handshake_done, self._has_missed_settings = False, True
        if self._collector.hub.register(self.robot, self, dry_run=hello.dry_run):
            self._collector.counters.replaced_connections += 1
            log.warning(
                "%s: its guard has connected twice, the newest connection stays", self.robot
            )
        handshakes = self._collector.threads.handshakes
        while self._has_missed_settings:
            self._has_missed_settings = False
            settings = await self._loop.run_in_executor(
                handshakes, self._collector.handle_hello, self.robot, hello
            )
        self._is_handshake_done, self._settings, self._has_unsent_settings = True, settings, True
        register = self._collector.register_robot
        known = await self._loop.run_in_executor(handshakes, register, self.robot)
        self._robot_id = known or 0
        self._has_outgoing.set()
        if hello.renews_token and self._collector.token_renewal:
            self._collector.token_renewal.add(self, self._token, self._offer_token)
        if hello.held_heads and self._robot_id:
            self._checking = asyncio.create_task(self._check_heads(hello.held_heads))

    async def _check_heads(self, documents: Documents) -> None:
        """Compare what the guard keeps of the log with the log; what differs is an alarm of it."""
        collector = self._collector
        found = await self._loop.run_in_executor(
            collector.threads.heads, collector.heads_check.check, self.robot, documents
        )
        if found:
            self._log_alarms = tuple(each.alarm for each in found)
            if state := collector.hub.state(self.robot):
                self._set_state(state)
            events = [each.event(collector.clock()) for each in found]
            batch = EventBatch(self._robot_id, self.robot, events)
            await collector.event_writer.put(QueuedBatch(batch, 0, lambda _is_stored: None))

    def _set_state(self, state: GuardState) -> None:
        """Tell what the guard is at, with the alarms that this service has found itself."""
        if self._log_alarms:
            state = replace(state, alarms=(*state.alarms, *self._log_alarms))
        self._collector.hub.set_state(self.robot, self, state)

    def _offer_token(self, secret: str) -> None:
        """Send the next secret of the token; it counts once the guard has stored it."""
        self._next_token, self._has_unsent_token = secret, True
        self._has_outgoing.set()

    async def _use_next_token(self) -> None:
        """Hold the connection by the next secret, and then end the one before."""
        renewal = self._collector.token_renewal
        if not (renewal and self._next_token):
            raise CloseConnectionError(CloseCode.MALFORMED, "no token was renewed")
        self._token, self._next_token = self._next_token, ""
        self._collector.token_watch.add(self, self._token, self._end_with_token)
        await renewal.promote(self._token)
        renewal.add(self, self._token, self._offer_token)

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
        receipt = self._receipts.accept(events)
        if receipt is None:
            return
        batch = EventBatch(self._robot_id, self.robot, events)
        await self._collector.event_writer.put(
            QueuedBatch(batch, size, partial(self._handle_stored, events, receipt))
        )

    def _handle_stored(
        self,
        events: Sequence[GuardEvent],
        receipt: int,
        is_stored: bool,  # noqa: FBT001 - the answer
    ) -> None:
        if is_stored:
            self._receipts.confirm(events, receipt)
        else:
            self._collector.counters.failed_batches += 1
            self._receipts.refuse(events)
        if not (is_stored or self._takes_refusals):
            self._close(CloseConnectionError(CloseCode.FAILED, "the events could not be stored"))
        self._has_outgoing.set()

    async def _store_incident(self, report: IncidentReport) -> None:
        """Keep the report of an incident and say so; nothing more is read meanwhile."""
        if self._loop.time() - self._incident_at < MIN_INCIDENT_INTERVAL_S:
            raise CloseConnectionError(CloseCode.TOO_MUCH, "reports of incidents come too fast")
        if not self._robot_id:
            raise CloseConnectionError(CloseCode.FAILED, "the incident could not be stored")
        is_stored = await self._loop.run_in_executor(
            self._collector.threads.incidents,
            self._collector.store_incident,
            self._robot_id,
            report,
        )
        self._incident_at = self._loop.time()
        if is_stored:
            self._stored_incident = report.name
            self._has_outgoing.set()

    async def _find_plan(self, digest: str) -> None:
        """Send the plan document that the robot's settings name."""
        threads, collector = self._collector.threads, self._collector
        self._unsent_plan = await self._loop.run_in_executor(
            threads.answers, collector.find_plan_document, self.robot, digest
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

    def _outgoing_messages(self) -> Iterator[ToGuard]:
        if self._has_unsent_settings:
            self._has_unsent_settings = False
            now = self._collector.steady_clock()
            yield NewSettings(
                settings=self._settings,
                now=now,
                takes_state_deltas=True,
                takes_incidents=True,
                takes_requests=True,
            )
        if self._has_unsent_token:
            self._has_unsent_token = False
            yield RenewedToken(token=self._next_token)
        yield from self._commands.take()
        yield from self._receipts.take()
        if self._stored_incident:
            name, self._stored_incident = self._stored_incident, ""
            yield IncidentStored(name=name)
        if self._unsent_plan is not None:
            text, self._unsent_plan = self._unsent_plan, None
            yield PlanDocument(text=text)
        if self._unsent_heads:
            document, self._unsent_heads = self._unsent_heads, None
            yield AuditHeads(document=document)

    async def _send(self, text: str) -> None:
        try:
            with fail_after(self._collector.timeouts.sending):
                await self._socket.send_text(text)
        except TimeoutError:
            raise CloseConnectionError(CloseCode.TOO_SLOW, "what was sent was not read") from None

    def _end_with_token(self) -> None:
        self._close(CloseConnectionError(CloseCode.NO_TOKEN, "the token is revoked, or over"))

    def _set_settings(self, settings: Settings) -> None:
        if not self._is_handshake_done:
            self._has_missed_settings = True
        elif settings.revision > self._settings.revision:
            self._settings, self._has_unsent_settings = settings, True
            self._has_outgoing.set()

    def _add_command(self, command: PersonCommand, response: Future[CommandResponse]) -> None:
        self._commands.add(command, response)
        self._has_outgoing.set()

    def _set_heads(self, document: Mapping[str, Any]) -> None:
        if self._takes_heads and self._is_handshake_done:
            self._unsent_heads = dict(document)
            self._has_outgoing.set()

    def _close(self, closing: CloseConnectionError) -> None:
        self._closing = self._closing or closing
        self._has_outgoing.set()

    def _call_in_loop(self, call: Callable[[], None]) -> None:
        with suppress(RuntimeError):  # the service has ended
            self._loop.call_soon_threadsafe(call)
