"""The fields of an entry that somebody else wrote, each of the type that it should have."""

from collections.abc import Sequence
from typing import Any, TypeVar

from rtron.functions.reading.json_lines import Document
from rtron.functions.reading.skipped_entries import (
    SkippedEntry,
    SkippedHandler,
    UnreadableEntryError,
)

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
