"""The link process's way to the service: events out of the spool, settings in."""

import asyncio
import logging
import random
import ssl
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import TypeAlias

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake, InvalidStatus

from rtron.errors import RTronError
from rtron.guard.link.audit_heads import HeadsFile
from rtron.guard.link.bridge_requests import BridgeRequests
from rtron.guard.link.incident_reports import IncidentReports
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.spool import Row, Spool
from rtron.wire.common.link_protocol import (
    MAX_MESSAGE_BYTES,
    Applied,
    ApprovalCommand,
    AuditHeads,
    CommandResponse,
    EventsRefused,
    Hello,
    IncidentStored,
    LeaseCommand,
    NewSettings,
    PlanDocument,
    PlanRequest,
    RenewedToken,
    RenewedTokenStored,
    StateDelta,
    StateReport,
    Stored,
    decode_to_guard,
    encode_events,
    encode_from_guard,
)
from rtron.wire.common.state_deltas import state_delta

log = logging.getLogger(__name__)

_BATCH = 500
_BATCH_BYTES = MAX_MESSAGE_BYTES // 4
_IN_FLIGHT = 8 * _BATCH
_MIN_PAUSE_S, _MAX_PAUSE_S = 0.1, 10.0
_TIMEOUT_S = 10.0
_FORBIDDEN = (401, 403)
_MAX_REASON_BYTES = 200

GuardReport: TypeAlias = StateReport | Applied | CommandResponse | PlanRequest
"""What the guard says that is no event."""
_REFUSED_PAUSE_S = 4.0
_REPORT_PAUSE_S = 2.0


class ServiceConnection:
    """Keeps a connection to the service while there is a guard, or something to deliver."""

    def __init__(
        self,
        options: LinkOptions,
        spool: Spool,
        on_message: Callable[[NewSettings | LeaseCommand | PlanDocument], None],
        heads_file: HeadsFile,
    ) -> None:
        self._options = options
        self._spool = spool
        self._on_message, self._heads_file = on_message, heads_file
        self._hello: Hello | None = None
        self._outbox: list[GuardReport] = []
        self._wake_event = asyncio.Event()
        self._hello_changed = asyncio.Event()
        self._last_warning = ""
        self._takes_state_deltas = False
        self._incidents = IncidentReports(options)
        self._takes_incidents = asyncio.Event()
        self._bridge = BridgeRequests()
        self._takes_requests = asyncio.Event()
        self._answering: set[asyncio.Task[None]] = set()
        self._last_report: StateReport | None = None
        self._position = 0
        self._pause: asyncio.TimerHandle | None = None

    def announce(self, hello: Hello) -> None:
        """Speak for this life of the guard; a connection for another one ends."""
        self._hello = hello
        self._hello_changed.set()
        self._wake_event.set()

    def withdraw(self) -> None:
        """Speak for nobody until the next `announce`."""
        self._hello = None
        self._hello_changed.set()

    def queue_message(self, message: GuardReport) -> None:
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
        options = self._options
        try:
            async with connect_to_service(
                options.url, options.token(), options.tls_context()
            ) as socket:
                log.info("connected to %s", options.service)
                self._last_warning = ""
                await self._serve(socket)
                return True
        except (OSError, InvalidHandshake, ConnectionClosed, RTronError, TimeoutError) as error:
            self._warn(error)
            return False

    async def _serve(self, socket: ClientConnection) -> None:
        if self._hello is None:
            raise AssertionError("nobody connects without a guard")
        self._hello_changed.clear()
        self._takes_state_deltas, self._last_report = False, None
        self._takes_incidents.clear()
        self._takes_requests.clear()
        self._resend()
        hello = replace(self._hello, held_heads=self._heads_file.samples())
        await socket.send(encode_from_guard(hello), text=True)
        works = [
            asyncio.create_task(self._deliver(socket)),
            asyncio.create_task(self._receive(socket, hello.app)),
            asyncio.create_task(self._report_incidents(socket)),
            asyncio.create_task(self._watch_bridge(hello.app)),
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
        while True:
            self._wake_event.clear()
            for message in self._take_outbox():
                await socket.send(encode_from_guard(self._shortened(message)), text=True)
            rows = () if self._pause else self._next_events()
            if rows and len(rows) + self._in_flight() <= _IN_FLIGHT:
                self._position = rows[-1][0]
                await socket.send(encode_events(row[3] for row in rows), text=True)
            else:
                await self._wake_event.wait()

    async def _report_incidents(self, socket: ClientConnection) -> None:
        """Send the reports of incidents, each when the service has the one before."""
        await self._takes_incidents.wait()
        while True:
            await socket.send(await self._incidents.next_message(), text=True)
            await self._incidents.settle()
            await asyncio.sleep(_REPORT_PAUSE_S)

    async def _watch_bridge(self, app: str) -> None:
        await self._takes_requests.wait()
        await self._bridge.watch(app)

    def _carry_out(self, app: str, command: ApprovalCommand) -> None:
        """Let the bridge answer a request, while settings and stops go on to come."""

        async def carry_out() -> None:
            self.queue_message(await self._bridge.carry_out(app, command))

        task = asyncio.create_task(carry_out())
        self._answering.add(task)
        task.add_done_callback(self._answering.discard)

    def _shortened(self, message: GuardReport) -> GuardReport | StateDelta:
        """Return a state as what differs from the last one, if the service takes that."""
        if not isinstance(message, StateReport):
            return message
        message = replace(message, state=replace(message.state, requests=self._bridge.open))
        before, self._last_report = self._last_report, message
        if before is None or not self._takes_state_deltas:
            return message
        return state_delta(before.state, message.state) or message

    def _next_events(self) -> Sequence[Row]:
        return _bounded(self._spool.events_after(self._position, _BATCH))

    def _in_flight(self) -> int:
        """Return how many events are sent that the service has not confirmed, at most."""
        oldest = self._spool.events_after(0, 1)
        return max(0, self._position - oldest[0][0] + 1) if oldest else 0

    def _hold_events(self) -> None:
        """Send no events for a while, and then all of them again: the service cannot store them."""
        if self._pause is None:
            log.warning("%s cannot store events now: they wait here", self._options.service)
            pause = _REFUSED_PAUSE_S * (0.5 + random.random())  # noqa: S311 - no secret
            self._pause = asyncio.get_running_loop().call_later(pause, self._resend)

    def _resend(self) -> None:
        """Send events from the oldest on that the service has not confirmed."""
        if self._pause:
            self._pause.cancel()
        self._position, self._pause = 0, None
        self._wake_event.set()

    def _take_outbox(self) -> list[GuardReport]:
        taken, self._outbox = self._outbox, []
        return taken

    async def _receive(self, socket: ClientConnection, app: str) -> None:
        async for frame in socket:
            message = decode_to_guard(frame)
            if isinstance(message, Stored):
                self._spool.forget(message.run, message.number)
                self._wake_event.set()
            elif isinstance(message, EventsRefused):
                self._hold_events()
            elif isinstance(message, RenewedToken):
                await self._store_token(socket, message)
            elif isinstance(message, AuditHeads):
                self._heads_file.add(message.document)
            elif isinstance(message, IncidentStored):
                self._incidents.confirm(message.name)
            elif isinstance(message, ApprovalCommand):
                self._carry_out(app, message)
            else:
                if isinstance(message, NewSettings):
                    self._note_service(message)
                self._on_message(message)

    def _note_service(self, message: NewSettings) -> None:
        """Take note of what the service takes."""
        self._takes_state_deltas = message.takes_state_deltas
        if message.takes_incidents:
            self._takes_incidents.set()
        if message.takes_requests:
            self._takes_requests.set()

    async def _store_token(self, socket: ClientConnection, renewed: RenewedToken) -> None:
        """Keep the next secret; one that cannot be kept is not confirmed, and the old one stays."""
        try:
            await asyncio.to_thread(self._options.replace_token, renewed.token)
        except OSError as error:
            log.warning(
                "the token in %s cannot be renewed, and ends soon: %s",
                self._options.token_file,
                error.strerror,
            )
            return
        log.info("the token in %s is renewed", self._options.token_file)
        await socket.send(encode_from_guard(RenewedTokenStored()), text=True)

    def _warn(self, error: Exception) -> None:
        message = str(error)
        if isinstance(error, InvalidStatus) and error.response.status_code in _FORBIDDEN:
            reason = (error.response.body or b"")[:_MAX_REASON_BYTES].decode(errors="replace")
            message = f"the service refuses the token in {self._options.token_file}: {reason}"
        if message != self._last_warning:
            self._last_warning = message
            log.warning("not connected to %s, tried again: %s", self._options.service, message)


def connect_to_service(url: str, token: str, tls: ssl.SSLContext | None = None) -> connect:
    """Return a connection to open as a guard's link; `tls` is needed for a service that has TLS."""
    return connect(
        url,
        additional_headers={"Authorization": f"Bearer {token}"},
        ssl=tls,
        max_size=MAX_MESSAGE_BYTES,
        open_timeout=_TIMEOUT_S,
        ping_interval=_TIMEOUT_S,
        ping_timeout=_TIMEOUT_S,
        close_timeout=1,
        compression=None,
        proxy=None,
    )


def _bounded(rows: Sequence[Row]) -> Sequence[Row]:
    """Return the first of these events, as many as one message may have; one at least."""
    lengths = accumulate(len(body) for *_, body in rows)
    fitting = sum(length <= _BATCH_BYTES for length in lengths)
    return rows[: max(1, fitting)]
