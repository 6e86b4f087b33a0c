"""The link process: between a guard, which must not wait, and a service, which may be away."""

import asyncio
import logging
import os
import signal
import socket
import sqlite3
import time
from contextlib import suppress
from dataclasses import replace
from typing import Any

from rtron.errors import RTronError, SourceError, WireError
from rtron.guard.link.audit_heads import HeadsFile
from rtron.guard.link.event_recorder import forget_run, former_runs
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.plan_intake import PlanIntake, PutInForce
from rtron.guard.link.service_connection import ServiceConnection
from rtron.guard.link.settings_file import read_settings, write_settings
from rtron.guard.link.spool import Spool
from rtron.guard.system.machine_time import machine_time
from rtron.guard.system.process_attributes import lower_priority
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.guard.system.unix_socket import peer_credentials
from rtron.vocabulary import SECOND, GuardEvent, Settings
from rtron.wire.common.link_protocol import (
    MAX_MESSAGE_BYTES,
    Applied,
    CommandResponse,
    Events,
    FromGuard,
    Hello,
    LeaseCommand,
    NewSettings,
    PlanDocument,
    StateReport,
    Stored,
    decode_from_guard,
    encode_event,
    encode_to_guard,
)


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


log = logging.getLogger(__name__)

_DRAIN_S = 2.0
_NICE = 10
"""The guard's messages go before what is told about them (nice(2), SCHED_BATCH of sched(7))."""
_RECONNECT_S = 2.0


class Relay:
    """Serves one guard at a time, the next one when the one before is gone."""

    def __init__(self, options: LinkOptions, put_in_force: PutInForce | None = None) -> None:
        self._options = options
        self._spool = Spool(options.spool_file)
        heads_file = HeadsFile(options.audit_heads_file)
        self._service = ServiceConnection(options, self._spool, self._on_message, heads_file)
        self._plans = PlanIntake(options.plans, self._service.queue_message, put_in_force)
        self._guard_writer: LineWriter | None = None
        self._serving: set[asyncio.Task[None]] = set()
        self._has_guard = False
        self._settings = _saved_settings(options)
        self._former_settings = self._settings

    async def run(self, ended: asyncio.Event) -> None:
        """Relay until `ended`.

        SourceError if another link process has the same state.
        """
        server = await asyncio.start_unix_server(
            self._serve, sock=self._bind(), limit=MAX_MESSAGE_BYTES
        )
        works: list[asyncio.Task[Any]] = [
            asyncio.create_task(self._service.run()),
            asyncio.create_task(ended.wait()),
        ]
        async with server:
            done, _ = await asyncio.wait(works, return_when=asyncio.FIRST_COMPLETED)
            await self._drain()
            self._has_guard = bool(self._serving)
            for task in self._serving:
                task.cancel()
            await asyncio.gather(*self._serving, return_exceptions=True)
        self._plans.close()
        for work in works:
            work.cancel()
        await asyncio.gather(*works, return_exceptions=True)
        self._release_files()
        for work in done:
            work.result()

    def _release_files(self) -> None:
        """Leave nothing in memory that only a guard which lives could need."""
        if not self._has_guard:
            self._report_killed_runs("")
            with suppress(OSError):  # it holds counters of unreported runs
                self._options.counter_folder.rmdir()
        self._spool.close()

    def _bind(self) -> socket.socket:
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            sock.bind(self._options.address)
        except OSError:
            sock.close()
            message = f"another link process has {self._options.state}"
            raise SourceError(
                message, help="give each guard a folder of its own with --state-dir"
            ) from None
        sock.listen()
        return sock

    async def _drain(self) -> None:
        """Give what waits a moment to go."""
        with suppress(asyncio.TimeoutError):  # the rest is lost with the link
            await asyncio.wait_for(self._spool.is_empty.wait(), _DRAIN_S)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if peer_credentials(writer.get_extra_info("socket"))[1] != os.getuid():
            writer.close()
            return
        if self._serving:  # a guard that was killed has said things that are not read yet
            await asyncio.wait(self._serving, timeout=_RECONNECT_S)
        if self._serving:
            log.warning("another guard is connected: give each its own --state-dir")
            writer.close()
            return
        task = asyncio.create_task(self._receive_lines(reader, writer))
        self._serving.add(task)
        task.add_done_callback(self._serving.discard)
        with suppress(asyncio.CancelledError):  # the link is ending
            await task

    async def _receive_lines(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        self._guard_writer = LineWriter(writer.get_extra_info("socket"))
        try:
            async for line in reader:
                self._receive(decode_from_guard(line.rstrip(b"\n")))
        except (RTronError, ValueError, OSError, sqlite3.Error) as error:
            log.warning("the guard's connection ends: %s", error)
        finally:
            self._guard_writer.close()
            writer.close()
            self._guard_writer = None
            asyncio.get_running_loop().call_later(_RECONNECT_S, self._withdraw)

    def _withdraw(self) -> None:
        """Let the service see that the guard is gone, once it has what the guard said."""
        if self._guard_writer is None and self._spool.waiting:
            asyncio.get_running_loop().call_later(_RECONNECT_S, self._withdraw)
        elif self._guard_writer is None:
            self._service.withdraw()

    def _receive(self, message: FromGuard) -> None:
        if isinstance(message, Hello):
            self._on_hello(message)
        elif isinstance(message, Events):
            self._store_events(message.events)
        elif isinstance(message, Applied):
            self._on_applied(message)
        elif isinstance(message, StateReport | CommandResponse):
            self._service.queue_message(message)
        else:
            raise WireError("a guard gives its link whole states, and no reports")

    def _on_hello(self, hello: Hello) -> None:
        self._plans.note_hello(hello.plan)
        if self._settings and self._settings.revision > hello.revision:
            self._send_settings(self._settings)
        settings = _shifted(hello.settings, time.time_ns() - machine_time().now)
        robot = self._options.robot
        self._service.announce(
            replace(
                hello,
                robot=robot,
                settings=settings,
                renews_token=True,
                takes_audit_heads=True,
                takes_refusals=True,
                takes_lease_commands=True,
                takes_approval_commands=True,
            )
        )
        self._report_killed_runs(hello.run)

    def _report_killed_runs(self, run: str) -> None:
        """Find out what the guards before took with them when they were killed."""
        for former, number in former_runs(self._options.counter_folder, run):
            missing = number - self._spool.highest_number(former)
            if missing > 0:
                self._report_lost(missing, "the guard was killed", former)
            forget_run(self._options.counter_folder, former)
        self._spool.prune(run)

    def _store_events(self, events: tuple[GuardEvent, ...]) -> None:
        if not events:
            return
        self._spool.add((event, encode_event(event)) for event in events)
        if lost := self._spool.take_lost():
            self._report_lost(lost, "the service was away for too long")
        self._service.wake()
        self._send(Stored(run=events[-1].run, number=events[-1].number))

    def _report_lost(self, count: int, why: str, run: str = "") -> None:
        event = self._spool.report_lost(time.time_ns(), count, why, run)
        self._spool.add([(event, encode_event(event))])
        log.warning("%s", event.reason)

    def _on_message(self, message: NewSettings | LeaseCommand | PlanDocument) -> None:
        """Give the guard what the service says; a command for a lease is not kept for another."""
        if isinstance(message, LeaseCommand):
            self._send(message)
        elif isinstance(message, PlanDocument):
            self._plans.take_document(message.text)
        else:
            self._on_settings(message)

    def _on_settings(self, message: NewSettings) -> None:
        """Give settings to the guard, and keep them before it can have answered.

        A disk that is full keeps nothing, but no stop from the robot either.
        """
        settings = _shifted(message.settings, machine_time().now - message.now)
        self._former_settings, self._settings = self._settings, settings
        self._send_settings(self._settings)
        self._save_settings(self._settings)
        self._plans.want(self._settings)

    def _save_settings(self, settings: Settings) -> None:
        try:
            write_settings(self._options.settings_file, settings, machine_time())
        except OSError as error:
            log.error("settings do not outlive this guard: %s", error)  # noqa: TRY400

    def _on_applied(self, applied: Applied) -> None:
        current = self._settings
        if applied.error and current and applied.revision == current.revision:
            self._restore_settings(current)
        if answer := self._plans.answer(applied):
            self._service.queue_message(answer)

    def _restore_settings(self, refused: Settings) -> None:
        """Keep what was in force before the guard refused something; a stop is never refused."""
        self._settings = self._former_settings
        if refused.stop:
            self._settings = replace(self._former_settings or Settings(), stop=refused.stop)
        if self._settings:
            self._save_settings(self._settings)
        else:
            self._options.settings_file.unlink(missing_ok=True)

    def _send_settings(self, settings: Settings) -> None:
        self._send(NewSettings(settings=settings, now=machine_time().now))

    def _send(self, message: Stored | NewSettings | LeaseCommand) -> None:
        if self._guard_writer:
            self._guard_writer.write(encode_to_guard(message))


def _shifted(settings: Settings, ahead: int) -> Settings:
    """Return settings by a clock that is so far `ahead` (ns): the machine's, or the wall clock."""
    overrides = {
        id: replace(override, until=override.until + ahead)
        for id, override in settings.overrides.items()
    }
    return replace(settings, overrides=overrides)


def _saved_settings(options: LinkOptions) -> Settings | None:
    """Return the settings that were kept; where they cannot be read, the guard stops the robot."""
    try:
        return read_settings(options.settings_file, machine_time())
    except SourceError as error:
        log.error("%s", error)  # noqa: TRY400 - the reason is in it
        return None


def run_relay(options: LinkOptions, put_in_force: PutInForce, beat: SharedBeat) -> None:
    """Be the link process until told to end; `beat` for the supervisor while it is well."""
    lower_priority(_NICE)
    asyncio.run(_run(options, put_in_force, beat))


async def _run(options: LinkOptions, put_in_force: PutInForce, beat: SharedBeat) -> None:
    ended = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, ended.set)
    beating = asyncio.create_task(_keep_beating(beat))
    await Relay(options, put_in_force).run(ended)
    beating.cancel()


async def _keep_beating(beat: SharedBeat) -> None:
    while True:
        beat.at = time.monotonic_ns()
        await asyncio.sleep(SharedBeat.PERIOD / SECOND)
