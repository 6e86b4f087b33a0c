"""The fields of an entry that somebody else wrote, each of the type that it should have."""

from collections.abc import Sequence
from typing import Any, TypeVar

from rtron.functions.reading.json_lines import Document
from rtron.functions.reading.skipped_entries import Note, Skipped, UnreadableError

MAX_NAME = 256
MAX_TEXT = 64 * 2**10
MAX_PACKAGES = 2000
T = TypeVar("T")


def name(document: Document, key: str) -> str:
    """Return a name, which must be there; raise UnreadableError for others."""
    found = document.get(key)
    if not isinstance(found, str) or not found.strip():
        raise UnreadableError(f"{key} is no name")
    if len(found) > MAX_NAME:
        raise UnreadableError(f"{key} is longer than {MAX_NAME} characters")
    return found.strip()


def text(document: Document, key: str) -> str:
    """Return a text of at most MAX_TEXT characters, "" without one; raise for others."""
    found = document.get(key)
    if found is None:
        return ""
    if not isinstance(found, str):
        raise UnreadableError(f"{key} is no text")
    return found[:MAX_TEXT]


def entries(document: Document, key: str) -> list[Any]:
    """Return a list, empty without one; raise UnreadableError for others."""
    found = document.get(key)
    if found is None:
        return []
    if not isinstance(found, list):
        raise UnreadableError(f"{key} is no list")
    return found


def mapping(found: object, what: str) -> Document:
    """Return what should be an object; raise UnreadableError if it is none."""
    if not isinstance(found, dict):
        raise UnreadableError(f"{what} is no object")
    return found


def first_packages(found: Sequence[T], place: str, note: Note) -> Sequence[T]:
    """Return the first MAX_PACKAGES of a repository; that there are more goes to `note`."""
    if len(found) > MAX_PACKAGES:
        why = f"has more than {MAX_PACKAGES} packages; the others are left out"
        note(Skipped(place=place, why=why))
    return found[:MAX_PACKAGES]
