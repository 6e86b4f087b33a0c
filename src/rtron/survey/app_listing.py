"""Which apps a folder of repositories has."""

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.functions.reading.folder import repository_folders
from rtron.functions.reading.skipped_entries import Note, Skipped
from rtron.sources.launch.ros1.file_search import ListedLaunch, launch_files

Included: TypeAlias = tuple[str, str]
"""A package, and the end of the path of a launch file in it."""

_FOUND = re.compile(r"\$\(find (\S+?)\)(/[^$]+)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """An app to scan: a launch file of a repository; `top` is where the others are looked for."""

    top: Path
    repository: Path
    launch: Path

    @property
    def app(self) -> str:
        """The launch file below the top, which names the app."""
        return str(self.launch.relative_to(self.top))


def subjects(top: Path, note: Note) -> Iterator[Subject]:
    """Yield the apps of the repositories below a folder.

    An app is a launch file that no other includes and that needs no arguments: one that needs some,
    or cannot be read, is noted. Raise InputError if the folder cannot be read.
    """
    top = top.absolute()
    found = {folder: _launches(folder, note) for folder in repository_folders(top)}
    included = frozenset(_included(each for listed in found.values() for each in listed))
    for repository, listed in found.items():
        for launch in (each for each in listed if not _is_included(each, included)):
            subject = Subject(top=top, repository=repository, launch=launch.path)
            why = launch.fault or _needs(launch.required)
            if why:
                note(Skipped(place=subject.app, why=why))
            else:
                yield subject


def _launches(folder: Path, note: Note) -> tuple[ListedLaunch, ...]:
    try:
        return launch_files([folder])
    except InputError as error:
        note(Skipped(place=str(folder), why=error.why))
        return ()


def _included(launches: Iterable[ListedLaunch]) -> Iterator[Included]:
    for launch in launches:
        for spelled in launch.includes:
            match = _FOUND.fullmatch(spelled)
            if match:
                yield match[1], match[2]


def _is_included(launch: ListedLaunch, included: Collection[Included]) -> bool:
    path = str(launch.path)
    return any(package == launch.package and path.endswith(end) for package, end in included)


def _needs(arguments: tuple[str, ...]) -> str:
    return f"needs the arguments {', '.join(arguments)}" if arguments else ""
