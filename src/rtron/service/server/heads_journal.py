"""The files of published heads: two of bounded size, and what they forget is proven by the rest.

A head commits to every entry before it. So an older head may go once the chain that has it also has
one that is kept: whoever changes what it proved contradicts the newer one.
"""

import asyncio
import fcntl
import io
import json
import logging
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping, Sequence
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from rtron.errors import WireError
from rtron.service.domain.clock import Clock
from rtron.service.domain.hash_chain import DocumentSigner, Head, heads_of
from rtron.service.live.hub import Hub
from rtron.service.server.audit_key import HEADS_FILE, OLDER_HEADS_FILE
from rtron.service.store.chains import (
    SERVICE_CHAIN,
    audit_chain,
    chain_heads,
    contradicted_heads,
    events_chain,
)
from rtron.service.store.database import Database

log = logging.getLogger(__name__)

MAX_FILE_BYTES = 16 << 20
"""A file of so many bytes becomes the older one, and the one before that goes."""
_FILE_MODE = 0o644
"""Heads are no secret, and what they prove is for others."""
_PAGE_HEADS = 2000
_BLOCK = 1 << 16


class HeadsJournal:
    """Appends heads to the files in a folder, which several replicas may share."""

    def __init__(self, folder: Path, database: Database) -> None:
        self._folder, self._database = folder, database
        self._file, self._older = folder / HEADS_FILE, folder / OLDER_HEADS_FILE

    def append(self, document: Mapping[str, Any]) -> None:
        """Append a document, whole or not at all; the file may be moved away in between."""
        line = json.dumps(document).encode() + b"\n"
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND
        with self._locked(), os.fdopen(os.open(self._file, flags, _FILE_MODE), "r+b", 0) as file:
            size = _whole_lines(file)
            file.truncate(size)
            try:
                _write_all(file, line)
                os.fsync(file.fileno())
            except OSError:
                file.truncate(size)
                raise

    def rotate(self) -> bool:
        """Begin a new file if this one is full; whether it has, and wants the heads of all chains.

        As long as the log does not contain a head that would go, both files stay as they are.
        """
        with self._locked():
            if not self._file.exists() or self._file.stat().st_size < MAX_FILE_BYTES:
                return False
            if reason := self._first_contradiction():
                text = "%s grows: the log was changed, and %s proves it: %s"
                log.error(text, self._file, self._older, reason)
                return False
            self._file.replace(self._older)
            return True

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Let no other replica rotate the same files at once."""
        descriptor = os.open(self._folder, os.O_RDONLY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
        finally:
            os.close(descriptor)

    def _first_contradiction(self) -> str:
        """Return what of the older file is not in the log, or nothing."""
        for heads in _pages(self._older):
            with self._database.session() as session:
                for chain, _, reason in contradicted_heads(session, heads):
                    return f"{chain}: {reason}"
        return ""


def _whole_lines(file: io.FileIO) -> int:
    """Return the bytes of a file up to its last line that is whole: a power cut may cut one off."""
    end = file.seek(0, os.SEEK_END)
    position = end
    while position:
        position = max(0, position - _BLOCK)
        file.seek(position)
        last = file.read(min(_BLOCK, end - position)).rfind(b"\n")
        if last >= 0:
            return position + last + 1
    return 0


def _write_all(file: io.FileIO, data: bytes) -> None:
    while data:
        data = data[file.write(data) or 0 :]


def heads_files(folder: Path) -> Sequence[Path]:
    """Return the files of published heads that are there, the older one first."""
    return [path for name in (OLDER_HEADS_FILE, HEADS_FILE) if (path := folder / name).exists()]


def _pages(path: Path) -> Iterator[Mapping[str, Sequence[Head]]]:
    """Yield the heads of a file, some at a time; a line that a crash has cut off proves nothing."""
    page: dict[str, list[Head]] = {}
    size = 0
    for heads in _documents(path):
        for chain, head in heads.items():
            page.setdefault(chain, []).append(head)
        size += len(heads)
        if size >= _PAGE_HEADS:
            yield page
            page, size = {}, 0
    yield page


def _documents(path: Path) -> Iterator[Mapping[str, Head]]:
    if not path.exists():
        return
    with path.open("rb") as file:
        yield from map(_heads_in, file)


def _heads_in(line: bytes) -> Mapping[str, Head]:
    try:
        return heads_of(json.loads(line))
    except (ValueError, RecursionError, WireError):
        log.warning("a line among the published heads is none")
        return {}


Heads = Mapping[str, Head]


class HeadPublisher:
    """Publishes what has changed every `interval_s` seconds, and once more at the end."""

    def __init__(
        self,
        database: Database,
        hub: Hub,
        signer: DocumentSigner,
        clock: Clock,
        *,
        journal: HeadsJournal,
        interval_s: float,
        on_heads: Callable[[Mapping[str, Any]], Awaitable[None]],
    ) -> None:
        """`on_heads` is awaited with each document that goes into the journal."""
        self._database, self._hub, self._signer, self._clock = database, hub, signer, clock
        self._journal, self._interval_s, self._on_heads = journal, interval_s, on_heads
        self._published: Heads = {}
        self._sent: dict[str, Heads] = {}

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Publish until the end of the block."""
        task = asyncio.create_task(self._run())
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            await self.publish()

    async def publish(self) -> None:
        """Publish what has changed since the last time; what fails is published the next time."""
        try:
            document = await asyncio.to_thread(self._publish)
        except (SQLAlchemyError, OSError) as error:
            log.error("the heads of the audit log are not published: %s", error)  # noqa: TRY400
            return
        if document:
            await self._on_heads(document)

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(self._interval_s)
            await self.publish()

    def _publish(self) -> Mapping[str, Any] | None:
        with self._database.session() as session:
            heads = chain_heads(session)
        now = self._clock()
        self._send_to_guards(heads, now)
        published = {} if self._journal.rotate() else self._published
        changed = {name: head for name, head in heads.items() if published.get(name) != head}
        if not changed:
            return None
        document = self._signer.sign_heads(now, changed)
        self._journal.append(document)
        self._published = heads
        return document

    def _send_to_guards(self, heads: Heads, now: int) -> None:
        """Give each guard the heads of its robot and of the service, if they have changed."""
        connected = self._hub.connected_robots()
        self._sent = {robot: sent for robot, sent in self._sent.items() if robot in connected}
        for robot in connected:
            names = SERVICE_CHAIN, audit_chain(robot), events_chain(robot)
            own = {name: heads[name] for name in names if name in heads}
            if own and self._sent.get(robot) != own:
                self._hub.send_heads(robot, self._signer.sign_heads(now, own))
                self._sent[robot] = own
