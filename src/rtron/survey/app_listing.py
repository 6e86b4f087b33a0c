"""Which apps a folder of repositories has."""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import TypeAlias

from pydantic import TypeAdapter

import rtron
from rtron.functions.reading.skipped_entries import SkippedEntry, SkippedHandler
from rtron.sources.bounded_file import content_hash
from rtron.sources.launch.common.launch_file import LaunchFileInfo
from rtron.sources.static.common.scan_options import Progress, ignore_progress
from rtron.survey.repository_reading import (
    SurveyedRepository,
    folder_digest,
    needed_repositories,
    read_repository,
    surveyed_folders,
)

IncludedLaunch: TypeAlias = tuple[str, str]
"""A package, and the end of the path of a launch file in it."""

_FIND_SUBSTITUTION = re.compile(r"\$\(find (\S+?)\)(/[^$]+)")
_TEST_FOLDERS = frozenset({"test", "tests"})
_SCAN_PACKAGES = ("findings", "functions", "risks", "sources", "vocabulary", "workflows")
_ROS2 = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class AppToScan:
    """An app to scan: a launch file of a repository, and the ROS that it is of.

    `others` are the repositories whose packages it may need, all below `top`; those of ROS 2 are as
    trusted as its own, since ROS 2 has one workspace. A result counts as long as `digest` is the
    same: it stands for RTron and for every file that is read.
    """

    top: Path
    repository: Path
    launch: Path
    ros: int = 1
    others: tuple[Path, ...] = ()
    digest: str = ""

    @property
    def name(self) -> str:
        """The launch file below the top, which names the app."""
        return str(self.launch.relative_to(self.top))

    @property
    def repository_name(self) -> str:
        """The repository below the top; the top's own name if it is the repository."""
        return self.repository.relative_to(self.top).as_posix().strip(".") or self.top.name


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanRequest:
    """An app to scan within `seconds`, with or without the user's cache of programs."""

    app: AppToScan
    seconds: float
    use_cache: bool = True


REQUEST_ADAPTER: TypeAdapter[ScanRequest] = TypeAdapter(ScanRequest)


def find_apps(
    top: Path, on_skipped: SkippedHandler, progress: Progress = ignore_progress
) -> Iterator[AppToScan]:
    """Yield the apps of the repositories below a folder.

    An app is a launch file that no other includes, that needs no arguments and that is no test: one
    that needs some, or cannot be read, is noted. Raise InputError if the folder cannot be read.
    """
    top = top.absolute()
    folders = surveyed_folders(top)
    repositories = []
    for number, folder in enumerate(folders):
        progress(number, len(folders), folder.name)
        repositories.append(read_repository(folder, on_skipped))
    yield from _apps(top, repositories, on_skipped)


def _apps(
    top: Path, repositories: Sequence[SurveyedRepository], on_skipped: SkippedHandler
) -> Iterator[AppToScan]:
    rtron_digest = _scan_digest()
    inclusions = _Inclusions(repositories)
    for repository in repositories:
        for ros in sorted({ros for _, ros in repository.launches.values()}):
            others = needed_repositories(repository, repositories, ros)
            digests = (rtron_digest, repository.digest, *(each.digest for each in others))
            app = AppToScan(
                top=top,
                repository=repository.folder,
                launch=repository.folder,
                ros=ros,
                others=tuple(each.folder for each in others),
                digest=sha256(" ".join(digests).encode()).hexdigest(),
            )
            for launch in repository.launches_of(ros):
                if not inclusions.include(launch, ros):
                    yield from _fit_app(replace(app, launch=launch.path), launch, on_skipped)


def _scan_digest() -> str:
    """Return a hash of the parts of RTron that a scan runs."""
    own = Path(rtron.__file__).parent
    folders = (folder_digest(own / package) for package in _SCAN_PACKAGES)
    return " ".join((*folders, content_hash(own / "survey" / "app_survey.py")))


def _fit_app(
    app: AppToScan, launch: LaunchFileInfo, on_skipped: SkippedHandler
) -> Iterator[AppToScan]:
    reason = _unfit_reason(launch, app.repository)
    if reason:
        on_skipped(SkippedEntry(location=app.name, reason=reason))
    else:
        yield app


def _unfit_reason(launch: LaunchFileInfo, repository: Path) -> str:
    """Return why a launch file is no app that can be scanned, empty if it is one."""
    if launch.error:
        return launch.error
    if launch.required:
        return f"needs the arguments {', '.join(launch.required)}"
    folders = launch.path.relative_to(repository).parts[:-1]
    return "is a test" if not _TEST_FOLDERS.isdisjoint(folders) else ""


@dataclass(frozen=True)
class _Inclusions:
    """Which launch files others include.

    ROS 1 spells an include as a package and a path. In ROS 2 an expression makes its path: a file
    is included where another names it, in the same package or beside that package's name.
    """

    repositories: Sequence[SurveyedRepository]

    def include(self, launch: LaunchFileInfo, ros: int) -> bool:
        """Tell whether one of the launch files includes another one."""
        if ros == _ROS2:
            return any(
                path != launch.path and (package == launch.package or launch.package in words)
                for path, package, words in self._naming[launch.path.name]
            )
        return _is_included(launch, self._ros1)

    @cached_property
    def _ros1(self) -> Collection[IncludedLaunch]:
        launches = chain.from_iterable(each.launches_of(1) for each in self.repositories)
        return frozenset(_included_files(launches))

    @cached_property
    def _naming(self) -> Mapping[str, Sequence[tuple[Path, str, frozenset[str]]]]:
        """Return the launch files of ROS 2 that name one, by the name of that."""
        launches = chain.from_iterable(each.launches_of(_ROS2) for each in self.repositories)
        names = {launch.path.name for launch in launches}
        found: defaultdict[str, list[tuple[Path, str, frozenset[str]]]] = defaultdict(list)
        for repository in self.repositories:
            for path, words in repository.words.items():
                for name in words & names:
                    found[name].append((path, repository.launches[path][0].package, words))
        return found


def _included_files(launches: Iterable[LaunchFileInfo]) -> Iterator[IncludedLaunch]:
    for launch in launches:
        for path in launch.includes:
            match = _FIND_SUBSTITUTION.fullmatch(path)
            if match:
                yield match[1], match[2]


def _is_included(launch: LaunchFileInfo, included: Collection[IncludedLaunch]) -> bool:
    path = str(launch.path)
    return any(package == launch.package and path.endswith(end) for package, end in included)
