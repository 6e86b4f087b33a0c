"""Which apps a folder of repositories has."""

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.functions.reading.folder import repository_folders
from rtron.functions.reading.skipped_entries import SkippedEntry, SkippedHandler
from rtron.sources.launch.common.launch_file import LaunchFileInfo
from rtron.sources.launch.ros1.file_search import find_launch_files

IncludedLaunch: TypeAlias = tuple[str, str]
"""A package, and the end of the path of a launch file in it."""

_FIND_SUBSTITUTION = re.compile(r"\$\(find (\S+?)\)(/[^$]+)")


@dataclass(frozen=True, slots=True, kw_only=True)
class AppToScan:
    """An app to scan: a launch file of a repository; `top` is where the others are looked for."""

    top: Path
    repository: Path
    launch: Path

    @property
    def name(self) -> str:
        """The launch file below the top, which names the app."""
        return str(self.launch.relative_to(self.top))


def find_apps(top: Path, on_skipped: SkippedHandler) -> Iterator[AppToScan]:
    """Yield the apps of the repositories below a folder.

    An app is a launch file that no other includes and that needs no arguments: one that needs some,
    or cannot be read, is noted. Raise InputError if the folder cannot be read.
    """
    top = top.absolute()
    launches = {folder: _launches(folder, on_skipped) for folder in repository_folders(top)}
    included = frozenset(_included_files(each for listed in launches.values() for each in listed))
    for repository, listed in launches.items():
        for launch in (each for each in listed if not _is_included(each, included)):
            subject = AppToScan(top=top, repository=repository, launch=launch.path)
            reason = launch.error or _missing_arguments(launch.required)
            if reason:
                on_skipped(SkippedEntry(location=subject.name, reason=reason))
            else:
                yield subject


def _launches(folder: Path, on_skipped: SkippedHandler) -> tuple[LaunchFileInfo, ...]:
    try:
        return find_launch_files([folder])
    except InputError as error:
        on_skipped(SkippedEntry(location=str(folder), reason=error.reason))
        return ()


def _included_files(launches: Iterable[LaunchFileInfo]) -> Iterator[IncludedLaunch]:
    for launch in launches:
        for path in launch.includes:
            match = _FIND_SUBSTITUTION.fullmatch(path)
            if match:
                yield match[1], match[2]


def _is_included(launch: LaunchFileInfo, included: Collection[IncludedLaunch]) -> bool:
    path = str(launch.path)
    return any(package == launch.package and path.endswith(end) for package, end in included)


def _missing_arguments(arguments: tuple[str, ...]) -> str:
    return f"needs the arguments {', '.join(arguments)}" if arguments else ""
