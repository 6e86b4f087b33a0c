"""Folders that somebody else made, however deep they are."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError

MAX_DEPTH = 100
IGNORE_MARKERS = frozenset({"AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"})
"""What lies in folders that neither catkin nor colcon builds (catkin_pkg, colcon-core)."""

SkipHandler: TypeAlias = Callable[[str, str], None]
"""Takes a folder that is not read, and why."""
FolderListing: TypeAlias = tuple[str, list[str], list[str]]
"""A folder, and the names of the folders and of the files in it."""


def is_folder(path: Path) -> bool:
    """Return whether a path is a folder; raise InputError for a path that cannot be looked at."""
    try:
        return path.is_dir()
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise InputError(why, path=str(path), help="check the path") from None


def path_exists(path: Path) -> bool:
    """Return whether a path leads to something; one that cannot be looked at does not."""
    return os.path.exists(path)  # noqa: PTH110 - Path.exists raises OSError for a long name


def _ignore_skipped(folder: str, why: str) -> None:
    """Leave a folder out."""


def walk(
    top: Path, on_skipped: SkipHandler = _ignore_skipped, *, follow_links: bool = False
) -> Iterator[FolderListing]:
    """Yield a folder and all below it, each before those in it, as os.walk does without recursion.

    What is taken out of a list of folders is not entered; links are, if `follow_links`. A folder
    that cannot be listed, or lies more than MAX_DEPTH folders deep, goes to `on_skipped`.
    """
    pending = [(str(top), 0)]
    while pending:
        folder, depth = pending.pop()
        try:
            listing = _list_folder(folder, depth)
        except OSError as error:
            on_skipped(folder, error.strerror or "cannot be read")
            continue
        yield listing
        subfolders = [f"{folder}/{name}" for name in reversed(listing[1])]
        pending += [(path, depth + 1) for path in subfolders if follow_links or not _is_link(path)]


def _list_folder(folder: str, depth: int) -> FolderListing:
    if depth > MAX_DEPTH:
        raise OSError(0, f"lies more than {MAX_DEPTH} folders deep")
    folders: list[str] = []
    files: list[str] = []
    with os.scandir(folder) as entries:
        for entry in entries:
            (folders if _is_folder_entry(entry) else files).append(entry.name)
    return folder, folders, files


def _is_link(path: str) -> bool:
    return os.path.islink(path)  # noqa: PTH114 - Path.is_symlink raises OSError for a long name


def _is_folder_entry(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:
        return False
