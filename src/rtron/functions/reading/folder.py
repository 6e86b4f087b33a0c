"""A repository's folder, or a folder of such folders."""

import os.path
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there, walk
from rtron.functions.reading import fields
from rtron.functions.reading.package_xml import MANIFEST, read_package
from rtron.functions.reading.readme import find_readme, read_readme
from rtron.functions.reading.skipped_entries import Note, Skipped, kept
from rtron.functions.repository import Repository

MAX_FOLDERS = 200_000
_IGNORED = frozenset({"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"})


def read_folders(top: Path, note: Note) -> Iterator[Repository]:
    """Yield the repository in a folder, or those in its folders; what cannot be read is noted.

    The folder of a repository may be a link, and counts by its own name. No link in it leads on.
    """
    for folder in repository_folders(top):
        places = fields.first_packages(_places(folder, note), str(folder), note)
        if places:
            yield from _repository(folder, places, note)
        else:
            note(Skipped(place=str(folder), why=f"has no {MANIFEST}"))


def repository_folders(top: Path) -> list[Path]:
    """Return `top` if it is one repository, else its folders.

    It is one if it has .git or a package.xml, or a README and no folder in it has .git.
    """
    inside = _folders(top)
    alone = _has(top, ".git") or _has(top, MANIFEST)
    several = any(_has(folder, ".git") for folder in inside)
    return [top] if alone or (find_readme(top, top.resolve()) and not several) else inside


def _folders(top: Path) -> list[Path]:
    try:
        return sorted(path for path in top.iterdir() if path.is_dir() and path.name[0] != ".")
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(top)) from None


def _has(folder: Path, name: str) -> bool:
    return is_there(folder / name)


def _places(folder: Path, note: Note) -> list[Path]:
    """Return up to MAX_PACKAGES + 1 folders of packages; the first that is not read is noted."""
    unread: list[Skipped] = []
    found = _package_folders(folder, unread)
    places = list(islice(found, fields.MAX_PACKAGES + 1))
    for skipped in unread[:1]:
        note(skipped)
    return places


def _repository(folder: Path, places: Sequence[Path], note: Note) -> Iterator[Repository]:
    """Yield the repository if one of its packages can be read."""
    root = folder.resolve()
    read = (kept(note, str(place / MANIFEST), read_package, place, root) for place in places)
    packages = tuple(package for package in read if package is not None)
    homes = dict.fromkeys([folder, *(places if len(places) == 1 else ())])
    readme = next(filter(None, (read_readme(home, root, note) for home in homes)), "")
    if packages:
        yield Repository(name=_name(folder), packages=packages, readme=readme)


def _name(folder: Path) -> str:
    return os.path.basename(os.path.abspath(folder))[: fields.MAX_NAME] or "/"  # noqa: PTH100, PTH119 - a link's own


def _package_folders(top: Path, unread: list[Skipped]) -> Iterator[Path]:
    """Yield the folders with a package.xml, as a build finds them: packages do not nest."""

    def leave(folder: str, why: str) -> None:
        unread.append(Skipped(place=folder, why=why))

    for number, (folder, subfolders, files) in enumerate(walk(top, leave)):
        if number == MAX_FOLDERS:
            leave(str(top), f"has more than {MAX_FOLDERS} folders; the others are left out")
            return
        ignored = not _IGNORED.isdisjoint(files)
        if MANIFEST in files and not ignored:
            yield Path(folder)
        if MANIFEST in files or ignored:
            subfolders.clear()
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
