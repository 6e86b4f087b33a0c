"""Lines of JSON from anywhere: bounded in length and number; a bad one costs itself only."""

import json
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

from rtron.errors import InputError
from rtron.functions.reading.skipped_entries import Note, UnreadableError, kept
from rtron.sources.bounded_file import STDIN

MAX_LINE = 2**20
MAX_BYTES = 2**28
Document: TypeAlias = Mapping[str, Any]


def json_lines(path: Path, note: Note) -> Iterator[tuple[str, Document]]:
    """Yield each line's object with its place, `file:line`; `-` is standard input.

    A line that is no object, or longer than MAX_LINE bytes, goes to `note`. Raise InputError for a
    file that cannot be opened, or has more than MAX_BYTES.
    """
    said = "standard input" if path == STDIN else str(path)
    try:
        with _opened(path) as stream:
            for number, line in _lines(stream, said):
                place = f"{said}:{number}"
                document = kept(note, place, _document, line)
                if document is not None:
                    yield place, document
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise InputError(why, path=said, help="check the path") from None


def _opened(path: Path) -> AbstractContextManager[BinaryIO]:
    return nullcontext(sys.stdin.buffer) if path == STDIN else path.open("rb")


def _lines(stream: BinaryIO, path: str) -> Iterator[tuple[int, bytes | None]]:
    """Yield each line that is not empty with its number, from 1; None for one too long."""
    number, cut = 1, False
    for piece in _pieces(stream, path):
        ends = piece.endswith(b"\n")
        if not cut and not piece.isspace():
            yield number, piece if ends or len(piece) < MAX_LINE else None
        cut = not ends
        number += ends


def _pieces(stream: BinaryIO, path: str) -> Iterator[bytes]:
    read = 0
    while piece := stream.readline(MAX_LINE):
        read += len(piece)
        if read > MAX_BYTES:
            help = "split it, and classify its parts one after the other"
            raise InputError(f"larger than {MAX_BYTES >> 20} MiB", path=path, help=help)
        yield piece


def _document(line: bytes | None) -> Document:
    if line is None:
        raise UnreadableError(f"longer than {MAX_LINE >> 20} MiB")
    try:
        document = json.loads(line)
    except json.JSONDecodeError as error:
        raise UnreadableError(f"not JSON: {error.msg}") from None
    except ValueError as error:
        raise UnreadableError(f"not JSON: {error}") from None
    except RecursionError:
        raise UnreadableError("nested too deep") from None
    if not isinstance(document, dict):
        raise UnreadableError("no JSON object")
    return document
