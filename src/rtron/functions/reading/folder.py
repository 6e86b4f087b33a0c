"""A repository's folder, or a folder of such folders."""

import os.path
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import IGNORE_MARKERS, path_exists, walk
from rtron.functions.reading import json_lines
from rtron.functions.reading.json_lines import MAX_NAME, MAX_TEXT
from rtron.functions.reading.skipped_entries import (
    SkippedEntry,
    SkippedHandler,
    UnreadableEntryError,
    read_or_skip,
)
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.launch.common.xml_document import Element, parse_xml
from rtron.sources.workspace.manifest import parse_manifest
from rtron.sources.workspace.package_files import is_inside, is_regular

_EXTENSIONS = (".md", ".markdown", ".rst", ".txt", "")


def read_readme(folder: Path, root: Path, on_skipped: SkippedHandler) -> str:
    """Return the beginning of a folder's README, "" without one; a binary one goes to `on_skipped`.

    `root` is the real folder of the repository.
    """
    path = find_readme(folder, root)
    if path is None:
        return ""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_TEXT)
    except OSError as error:
        on_skipped(SkippedEntry(location=str(path), reason=error.strerror or "cannot be read"))
        return ""
    if b"\0" in data:
        on_skipped(SkippedEntry(location=str(path), reason="is binary"))
        return ""
    return data.decode("utf-8", errors="replace")


def find_readme(folder: Path, root: Path) -> Path | None:
    """Return the README of a folder, Markdown before the others; no link out of the real `root`."""
    candidates = [
        path
        for path in folder.glob("[Rr][Ee][Aa][Dd][Mm][Ee]*")
        if path.suffix.lower() in _EXTENSIONS and is_regular(path) and is_inside(path, (root,))
    ]
    return min(candidates, key=_rank, default=None)


def _rank(path: Path) -> tuple[int, str]:
    return _EXTENSIONS.index(path.suffix.lower()), path.name


MANIFEST = "package.xml"


def read_package(folder: Path, root: Path) -> SourcePackage:
    """Return a folder's package; `root` is the real folder of the repository that it lies in.

    Raise UnreadableEntryError where its package.xml cannot be read, or lies elsewhere.
    """
    document = _parse_manifest(folder / MANIFEST, root)
    manifest = parse_manifest(document, folder)
    return SourcePackage(
        name=(document.findtext("name") or "").strip()[:MAX_NAME] or folder.name,
        description=manifest.description,
        depends=manifest.depends,
        folder=folder,
    )


def _parse_manifest(path: Path, root: Path) -> Element:
    if not is_inside(path, (root,)):
        raise UnreadableEntryError("is a link that leads out of the repository, or nowhere")
    try:
        return parse_xml(path)
    except InputError as error:
        raise UnreadableEntryError(error.reason, line=error.line) from None


MAX_FOLDERS = 200_000


def read_folders(top: Path, on_skipped: SkippedHandler) -> Iterator[SourceRepository]:
    """Yield the repository in a folder, or those in its folders; what cannot be read is noted.

    The folder of a repository may be a link, and counts by its own name. No link in it leads on.
    """
    for folder in repository_folders(top):
        package_folders = json_lines.first_packages(
            _first_package_folders(folder, on_skipped), str(folder), on_skipped
        )
        if package_folders:
            yield from _repository(folder, package_folders, on_skipped)
        else:
            on_skipped(SkippedEntry(location=str(folder), reason=f"has no {MANIFEST}"))


def repository_folders(top: Path) -> list[Path]:
    """Return `top` if it is one repository, else its folders.

    It is one if it has .git or a package.xml, or a README and no folder in it has .git.
    """
    inside = _subfolders(top)
    is_repository = _has(top, ".git") or _has(top, MANIFEST)
    has_repositories = any(_has(folder, ".git") for folder in inside)
    return (
        [top]
        if is_repository or (find_readme(top, top.resolve()) and not has_repositories)
        else inside
    )


def _subfolders(top: Path) -> list[Path]:
    try:
        return sorted(path for path in top.iterdir() if path.is_dir() and path.name[0] != ".")
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(top)) from None


def _has(folder: Path, name: str) -> bool:
    return path_exists(folder / name)


def _first_package_folders(folder: Path, on_skipped: SkippedHandler) -> list[Path]:
    """Return up to MAX_PACKAGES + 1 folders of packages; the first that is not read is noted."""
    unread: list[SkippedEntry] = []
    package_folders = _package_folders(folder, unread)
    folders = list(islice(package_folders, json_lines.MAX_PACKAGES + 1))
    for skipped in unread[:1]:
        on_skipped(skipped)
    return folders


def _repository(
    folder: Path, package_folders: Sequence[Path], on_skipped: SkippedHandler
) -> Iterator[SourceRepository]:
    """Yield the repository if one of its packages can be read."""
    root = folder.resolve()
    read = (
        read_or_skip(
            on_skipped, str(folder_of_package / MANIFEST), read_package, folder_of_package, root
        )
        for folder_of_package in package_folders
    )
    packages = tuple(package for package in read if package is not None)
    readme_folders = dict.fromkeys(
        [folder, *(package_folders if len(package_folders) == 1 else ())]
    )
    readme = next(
        filter(None, (read_readme(home, root, on_skipped) for home in readme_folders)), ""
    )
    if packages:
        yield SourceRepository(name=_repository_name(folder), packages=packages, readme=readme)


def _repository_name(folder: Path) -> str:
    return os.path.basename(os.path.abspath(folder))[: json_lines.MAX_NAME] or "/"  # noqa: PTH100, PTH119 - a link's own


def _package_folders(top: Path, skipped: list[SkippedEntry]) -> Iterator[Path]:
    """Yield the folders with a package.xml, as a build finds them: packages do not nest."""

    def skip(folder: str, reason: str) -> None:
        skipped.append(SkippedEntry(location=folder, reason=reason))

    for number, (folder, subfolders, files) in enumerate(walk(top, skip)):
        if number == MAX_FOLDERS:
            skip(str(top), f"has more than {MAX_FOLDERS} folders; the others are left out")
            return
        ignored = not IGNORE_MARKERS.isdisjoint(files)
        if MANIFEST in files and not ignored:
            yield Path(folder)
        if MANIFEST in files or ignored:
            subfolders.clear()
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
