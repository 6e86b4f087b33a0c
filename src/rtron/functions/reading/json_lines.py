"""Lines of JSON from anywhere: bounded in length and number; a bad one costs itself only."""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias, TypeVar

from rtron.errors import InputError
from rtron.functions.reading.skipped_entries import (
    SkippedEntry,
    SkippedHandler,
    UnreadableEntryError,
    read_or_skip,
)
from rtron.sources.bounded_file import STDIN

MAX_LINE = 2**20
MAX_BYTES = 2**28
Document: TypeAlias = Mapping[str, Any]


def read_json_lines(path: Path, on_skipped: SkippedHandler) -> Iterator[tuple[str, Document]]:
    """Yield each line's object with its place, `file:line`; `-` is standard input.

    A line that is no object, or longer than MAX_LINE bytes, goes to `on_skipped`. Raise InputError
    for a file that cannot be opened, or has more than MAX_BYTES.
    """
    file_name = "standard input" if path == STDIN else str(path)
    try:
        with _open_stream(path) as stream:
            for number, line in _lines(stream, file_name):
                location = f"{file_name}:{number}"
                document = read_or_skip(on_skipped, location, _document, line)
                if document is not None:
                    yield location, document
    except OSError as error:
        reason = error.strerror or "cannot be read"
        raise InputError(reason, path=file_name, help="check the path") from None


def _open_stream(path: Path) -> AbstractContextManager[BinaryIO]:
    return nullcontext(sys.stdin.buffer) if path == STDIN else path.open("rb")


def _lines(stream: BinaryIO, path: str) -> Iterator[tuple[int, bytes | None]]:
    """Yield each line that is not empty with its number, from 1; None for one too long."""
    number, is_continuation = 1, False
    for chunk in _chunks(stream, path):
        is_complete = chunk.endswith(b"\n")
        if not is_continuation and not chunk.isspace():
            yield number, chunk if is_complete or len(chunk) < MAX_LINE else None
        is_continuation = not is_complete
        number += is_complete


def _chunks(stream: BinaryIO, path: str) -> Iterator[bytes]:
    total_bytes = 0
    while chunk := stream.readline(MAX_LINE):
        total_bytes += len(chunk)
        if total_bytes > MAX_BYTES:
            help = "split it, and classify its parts one after the other"
            raise InputError(f"larger than {MAX_BYTES >> 20} MiB", path=path, help=help)
        yield chunk


def _document(line: bytes | None) -> Document:
    if line is None:
        raise UnreadableEntryError(f"longer than {MAX_LINE >> 20} MiB")
    try:
        document = json.loads(line)
    except json.JSONDecodeError as error:
        raise UnreadableEntryError(f"not JSON: {error.msg}") from None
    except ValueError as error:
        raise UnreadableEntryError(f"not JSON: {error}") from None
    except RecursionError:
        raise UnreadableEntryError("nested too deep") from None
    if not isinstance(document, dict):
        raise UnreadableEntryError("no JSON object")
    return document


MAX_NAME = 256
MAX_TEXT = 64 * 2**10
MAX_PACKAGES = 2000
T = TypeVar("T")


def required_name(document: Document, key: str) -> str:
    """Return a name, which must be there; raise UnreadableEntryError for others."""
    value = document.get(key)
    if not isinstance(value, str) or not value.strip():
        raise UnreadableEntryError(f"{key} is no name")
    if len(value) > MAX_NAME:
        raise UnreadableEntryError(f"{key} is longer than {MAX_NAME} characters")
    return value.strip()


def optional_text(document: Document, key: str) -> str:
    """Return a text of at most MAX_TEXT characters, "" without one; raise for others."""
    value = document.get(key)
    if value is None:
        return ""
    if not isinstance(value, str):
        raise UnreadableEntryError(f"{key} is no text")
    return value[:MAX_TEXT]


def optional_list(document: Document, key: str) -> list[Any]:
    """Return a list, empty without one; raise UnreadableEntryError for others."""
    value = document.get(key)
    if value is None:
        return []
    if not isinstance(value, list):
        raise UnreadableEntryError(f"{key} is no list")
    return value


def required_object(value: object, what: str) -> Document:
    """Return what should be an object; raise UnreadableEntryError if it is none."""
    if not isinstance(value, dict):
        raise UnreadableEntryError(f"{what} is no object")
    return value


def first_packages(packages: Sequence[T], location: str, on_skipped: SkippedHandler) -> Sequence[T]:
    """Return the first MAX_PACKAGES of a repository; that there are more goes to `on_skipped`."""
    if len(packages) > MAX_PACKAGES:
        reason = f"has more than {MAX_PACKAGES} packages; the others are left out"
        on_skipped(SkippedEntry(location=location, reason=reason))
    return packages[:MAX_PACKAGES]
