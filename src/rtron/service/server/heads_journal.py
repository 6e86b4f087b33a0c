"""The files of published heads: two of bounded size, and what they forget is proven by the rest.

A head commits to every entry before it. So an older head may go once the chain that has it also has
one that is kept: whoever changes what it proved contradicts the newer one.
"""

import fcntl
import io
import json
import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rtron.errors import WireError
from rtron.service.domain.hash_chain import Head
from rtron.service.domain.signed_documents import heads_of
from rtron.service.server.audit_key import HEADS_FILE, OLDER_HEADS_FILE
from rtron.service.store.database import Database
from rtron.service.store.held_heads import contradicted_heads

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
