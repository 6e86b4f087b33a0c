"""What a survey knows of a repository before a scan: its launch files, packages and state."""

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import walk
from rtron.functions.reading.folder import repository_folders
from rtron.functions.reading.skipped_entries import SkippedEntry, SkippedHandler
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.launch.common.launch_file import LaunchFileInfo
from rtron.sources.launch.common.packages import build_types
from rtron.sources.launch.common.xml_document import Element, parse_xml
from rtron.sources.launch.ros1.file_search import find_launch_files
from rtron.sources.launch.ros2.file_search import list_ros2_launch_files
from rtron.sources.workspace.manifest import parse_manifest

MANIFEST = "package.xml"
_MAX_LAUNCH_BYTES = 2**20
_COMMIT_MARK = "@"
_WORD = re.compile(r"\w[\w.-]*")


@dataclass(frozen=True, slots=True, kw_only=True)
class SurveyedRepository:
    """A repository: its launch files of either ROS, and the ROS of each of its packages.

    `words` has the words of each launch file. `named` are the packages that manifests depend on,
    and all words of launch files: some of them are packages. `digest` changes with any file.
    """

    folder: Path
    launches: Mapping[Path, tuple[LaunchFileInfo, int]]
    packages: Mapping[str, int]
    words: Mapping[Path, frozenset[str]]
    named: frozenset[str]
    digest: str

    def launches_of(self, ros: int) -> Iterator[LaunchFileInfo]:
        """Yield the launch files of one ROS."""
        return (launch for launch, generation in self.launches.values() if generation == ros)


def surveyed_folders(top: Path) -> list[Path]:
    """Return the repositories of a folder, also where they lie in it as `owner/name@commit`.

    Raise InputError if it cannot be read.
    """
    folders: list[Path] = []
    for folder in repository_folders(top):
        checkouts = sorted(each for each in folder.glob(f"*{_COMMIT_MARK}*") if each.is_dir())
        folders.extend(checkouts or [folder])
    return folders


def read_repository(folder: Path, on_skipped: SkippedHandler) -> SurveyedRepository:
    """Return what a repository has; a folder without end has no launch files, and is noted."""
    launches = _launches(folder, on_skipped)
    words = {path: _words(path) for path in launches}
    manifests = [each for each in map(_manifest, _manifest_paths(folder)) if each is not None]
    depends = (name for root, path in manifests for name in parse_manifest(root, path).depends)
    return SurveyedRepository(
        folder=folder,
        launches=launches,
        packages={_package_name(root, path): _generation(root) for root, path in manifests},
        words=words,
        named=frozenset(depends).union(*words.values()),
        digest=folder_digest(folder),
    )


def folder_digest(folder: Path) -> str:
    """Return a hash over the names, sizes and times of all files below a folder."""
    digest = sha256()
    for path, subfolders, files in walk(folder):
        subfolders[:] = sorted(name for name in subfolders if name not in {".git", "__pycache__"})
        for name in sorted(files):
            digest.update(
                f"{path}/{name} {_state(path, name)}\n".encode("utf-8", "surrogateescape")
            )
    return digest.hexdigest()


def _state(folder: str, name: str) -> tuple[int, int, int]:
    try:
        status = os.lstat(f"{folder}/{name}")
    except OSError:
        return 0, 0, 0
    return status.st_size, status.st_mtime_ns, status.st_mode


def _launches(
    folder: Path, on_skipped: SkippedHandler
) -> Mapping[Path, tuple[LaunchFileInfo, int]]:
    """Return the launch files by path; one that looks like ROS 1 in a package of ROS 2 is of 2."""
    try:
        found = [*((each, 1) for each in find_launch_files([folder]))]
        found += [(each, 2) for each in list_ros2_launch_files([folder])]
    except InputError as error:
        on_skipped(SkippedEntry(location=str(folder), reason=error.reason))
        return {}
    return {each.path: (each, ros) for each, ros in found}


def _words(path: Path) -> frozenset[str]:
    try:
        text = read_regular_file(path, _MAX_LAUNCH_BYTES).decode("utf-8", errors="replace")
    except InputError:
        return frozenset()
    return frozenset(_WORD.findall(text))


def _manifest_paths(folder: Path) -> Iterator[Path]:
    for path, subfolders, files in walk(folder):
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        if MANIFEST in files:
            yield Path(path, MANIFEST)


def _manifest(path: Path) -> tuple[Element, Path] | None:
    try:
        return parse_xml(path), path.parent
    except InputError:
        return None  # the scan of an app that needs the package says so


def _package_name(root: Element, folder: Path) -> str:
    return (root.findtext("name") or folder.name).strip()


def _generation(root: Element) -> int:
    return 2 if any(build.startswith("ament_") for build in build_types(root)) else 1


def needed_repositories(
    repository: SurveyedRepository, repositories: Iterable[SurveyedRepository], ros: int
) -> list[SurveyedRepository]:
    """Return the other repositories that have packages of one ROS which a repository may need.

    What these need in turn is among them. Of packages with one name the first counts.
    """
    providers: dict[str, SurveyedRepository] = {}
    for each in repositories:
        for package, generation in each.packages.items():
            if generation == ros:
                providers.setdefault(package, each)
    providers.update(dict.fromkeys(repository.packages, repository))
    needed: dict[Path, SurveyedRepository] = {repository.folder: repository}
    pending = [repository]
    while pending:
        for package in sorted(pending.pop().named & providers.keys()):
            provider = providers[package]
            if provider.folder not in needed:
                needed[provider.folder] = provider
                pending.append(provider)
    return [each for each in needed.values() if each is not repository]
