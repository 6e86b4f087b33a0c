"""The link process: between a guard, which must not wait, and a service, which may be away."""

import asyncio
import logging
import os
import signal
import socket
import sqlite3
import struct
import time
from contextlib import suppress
from dataclasses import replace

from rtron.errors import RTronError, SourceError
from rtron.guard.link.event_counter import forget_run, former_runs
from rtron.guard.link.line_writer import Mouth
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.service_connection import Post
from rtron.guard.link.settings_file import keep_settings, read_settings
from rtron.guard.link.spool import Spool
from rtron.vocabulary import GuardEvent, Settings
from rtron.wire.common.link_protocol import (
    LONGEST,
    Applied,
    Events,
    Hello,
    NewSettings,
    State,
    Stored,
    event_bytes,
    from_guard,
    service_bytes,
)

log = logging.getLogger(__name__)

_CREDENTIALS = struct.Struct("3i")
_DRAINING_S = 2.0
_LOOK_S = 1.0
_ALONE_S = 30.0
_NICE = 10
"""The guard's messages go before what is told about them (nice(2), SCHED_BATCH of sched(7))."""
_RETURN_S = 2.0


class Relay:
    """Serves one guard at a time, the next one when the one before is gone."""

    def __init__(self, options: LinkOptions) -> None:
        self._options = options
        self._spool = Spool(options.spool_file)
        self._post = Post(options, self._spool, self._new_settings)
        self._guard: Mouth | None = None
        self._serving: set[asyncio.Task[None]] = set()
        self._guarded = False
        self._settings = read_settings(options.settings_file, time.time_ns())
        self._before = self._settings
        self._alone_since = time.monotonic()
        self._parent = os.getppid()

    async def run(self, ended: asyncio.Event) -> None:
        """Relay until `ended`, or until nobody is left who needs it.

        SourceError if another link process has the same state.
        """
        server = await asyncio.start_unix_server(self._serve, sock=self._listening(), limit=LONGEST)
        works = [asyncio.create_task(self._post.run()), asyncio.create_task(self._needed(ended))]
        async with server:
            done, _ = await asyncio.wait(works, return_when=asyncio.FIRST_COMPLETED)
            await self._drained()
            self._guarded = bool(self._serving)
            for task in self._serving:
                task.cancel()
            await asyncio.gather(*self._serving, return_exceptions=True)
        for work in works:
            work.cancel()
        await asyncio.gather(*works, return_exceptions=True)
        self._close()
        for work in done:
            work.result()

    def _close(self) -> None:
        """Leave nothing in memory that only a guard which lives could need."""
        if not self._guarded:
            self._account("")
            with suppress(OSError):
                self._options.runs.rmdir()
        self._spool.close()

    def _listening(self) -> socket.socket:
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            sock.bind(self._options.address)
        except OSError:
            sock.close()
            told = f"another link process has {self._options.state}"
            raise SourceError(
                told, help="give each guard a folder of its own with --state"
            ) from None
        sock.listen()
        return sock

    async def _needed(self, ended: asyncio.Event) -> None:
        """End when told to, or when the supervisor is gone and no guard has come for a while."""
        while not self._is_alone():
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(ended.wait(), _LOOK_S)
                return

    def _is_alone(self) -> bool:
        alone = self._guard is None and time.monotonic() - self._alone_since > _ALONE_S
        return alone and os.getppid() != self._parent

    async def _drained(self) -> None:
        """Give what waits a moment to go."""
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._spool.emptied.wait(), _DRAINING_S)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if not _is_ours(writer):
            writer.close()
            return
        if self._serving:  # a guard that was killed has said things that are not read yet
            await asyncio.wait(self._serving, timeout=_RETURN_S)
        if self._serving:
            log.warning("another guard is connected: give each its own --state")
            writer.close()
            return
        task = asyncio.create_task(self._listen(reader, writer))
        self._serving.add(task)
        task.add_done_callback(self._serving.discard)
        with suppress(asyncio.CancelledError):
            await task

    async def _listen(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._guard = Mouth(writer.get_extra_info("socket"))
        try:
            async for line in reader:
                self._heard(from_guard(line.rstrip(b"\n")))
        except (RTronError, ValueError, OSError, sqlite3.Error) as error:
            log.warning("the guard's connection ends: %s", error)
        finally:
            self._guard.close()
            writer.close()
            self._guard = None
            self._alone_since = time.monotonic()
            asyncio.get_running_loop().call_later(_RETURN_S, self._leave)

    def _leave(self) -> None:
        """Let the service see that the guard is gone, once it has what the guard said."""
        if self._guard is None and self._spool.waiting:
            asyncio.get_running_loop().call_later(_RETURN_S, self._leave)
        elif self._guard is None:
            self._post.leave()

    def _heard(self, message: Hello | Events | State | Applied) -> None:
        if isinstance(message, Hello):
            self._greet(message)
        elif isinstance(message, Events):
            self._keep(message.events)
        elif isinstance(message, Applied):
            self._answered(message)
        else:
            self._post.say(message)

    def _greet(self, hello: Hello) -> None:
        if self._settings and self._settings.revision > hello.revision:
            self._give(self._settings)
        self._post.greet(replace(hello, robot=self._options.robot))
        self._account(hello.run)

    def _account(self, run: str) -> None:
        """Find out what the guards before took with them when they were killed."""
        for former, number in former_runs(self._options.runs, run):
            missing = number - self._spool.seen(former)
            if missing > 0:
                self._report(missing, "the guard was killed", former)
            forget_run(self._options.runs, former)
        self._spool.prune(run)

    def _keep(self, events: tuple[GuardEvent, ...]) -> None:
        if not events:
            return
        self._spool.add((event, event_bytes(event)) for event in events)
        if lost := self._spool.take_lost():
            self._report(lost, "the service was away for too long")
        self._post.has_news()
        self._tell(Stored(run=events[-1].run, number=events[-1].number))

    def _report(self, count: int, why: str, run: str = "") -> None:
        event = self._spool.report_lost(time.time_ns(), count, why, run)
        self._spool.add([(event, event_bytes(event))])
        log.warning("%s", event.reason)

    def _new_settings(self, message: NewSettings) -> None:
        """Give settings to the guard, and keep them before it can have answered.

        A disk that is full keeps nothing, but no stop from the robot either.
        """
        now = time.time_ns()
        self._before, self._settings = self._settings, _by_our_clock(message, now)
        self._give(self._settings)
        self._store(self._settings)

    def _store(self, settings: Settings) -> None:
        try:
            keep_settings(self._options.settings_file, settings, time.time_ns())
        except OSError as error:
            log.error("settings do not outlive this guard: %s", error)  # noqa: TRY400

    def _answered(self, applied: Applied) -> None:
        current = self._settings
        if applied.error and current and applied.revision == current.revision:
            self._take_back(current)
        self._post.say(applied)

    def _take_back(self, refused: Settings) -> None:
        """Keep what was in force before the guard refused something; a stop is never refused."""
        self._settings = self._before
        if refused.stop:
            self._settings = replace(self._before or Settings(), stop=refused.stop)
        if self._settings:
            self._store(self._settings)
        else:
            self._options.settings_file.unlink(missing_ok=True)

    def _give(self, settings: Settings) -> None:
        self._tell(NewSettings(settings=settings, now=time.time_ns()))

    def _tell(self, message: Stored | NewSettings) -> None:
        if self._guard:
            self._guard.say(service_bytes(message))


def _by_our_clock(message: NewSettings, now: int) -> Settings:
    """Return settings whose times are those of this machine's clock."""
    ahead = now - message.now
    overrides = {
        id: replace(override, until=override.until + ahead)
        for id, override in message.settings.overrides.items()
    }
    return replace(message.settings, overrides=overrides)


def _is_ours(writer: asyncio.StreamWriter) -> bool:
    sock = writer.get_extra_info("socket")
    data = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    return bool(_CREDENTIALS.unpack(data)[1] == os.getuid())


def run_relay(options: LinkOptions) -> None:
    """Be the link process until told to end; Ctrl-C is said to the supervisor."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(_NICE)
    os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    asyncio.run(_run(options))


async def _run(options: LinkOptions) -> None:
    ended = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, ended.set)
    await Relay(options).run(ended)
