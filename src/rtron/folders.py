"""Folders that somebody else made, however deep they are."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError

MAX_DEPTH = 100

Unread: TypeAlias = Callable[[str, str], None]
"""Takes a folder that is not read, and why."""
Listed: TypeAlias = tuple[str, list[str], list[str]]
"""A folder, and the names of the folders and of the files in it."""


def is_folder(path: Path) -> bool:
    """Return whether a path is a folder; raise InputError for a path that cannot be looked at."""
    try:
        return path.is_dir()
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise InputError(why, path=str(path), help="check the path") from None


def is_there(path: Path) -> bool:
    """Return whether a path leads to something; one that cannot be looked at does not."""
    return os.path.exists(path)  # noqa: PTH110 - Path.exists raises OSError for a long name


def _leave(folder: str, why: str) -> None:
    """Leave a folder out."""


def walk(top: Path, unread: Unread = _leave, *, links: bool = False) -> Iterator[Listed]:
    """Yield a folder and all below it, each before those in it, as os.walk does without recursion.

    What is taken out of a list of folders is not entered; links are, if `links`. A folder that
    cannot be listed, or lies more than MAX_DEPTH folders deep, goes to `unread`.
    """
    waiting = [(str(top), 0)]
    while waiting:
        folder, depth = waiting.pop()
        try:
            listed = _listed(folder, depth)
        except OSError as error:
            unread(folder, error.strerror or "cannot be read")
            continue
        yield listed
        below = [os.path.join(folder, name) for name in reversed(listed[1])]  # noqa: PTH118 - os.walk's spelling
        waiting += [(path, depth + 1) for path in below if links or not os.path.islink(path)]  # noqa: PTH114


def _listed(folder: str, depth: int) -> Listed:
    if depth > MAX_DEPTH:
        raise OSError(0, f"lies more than {MAX_DEPTH} folders deep")
    folders: list[str] = []
    files: list[str] = []
    with os.scandir(folder) as entries:
        for entry in entries:
            (folders if _leads_on(entry) else files).append(entry.name)
    return folder, folders, files


def _leads_on(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:
        return False
