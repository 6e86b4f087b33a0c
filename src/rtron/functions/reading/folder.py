"""A repository's folder, or a folder of such folders."""

import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from rtron.errors import InputError
from rtron.functions.reading.fields import MAX_NAME
from rtron.functions.reading.package_xml import MANIFEST, read_package
from rtron.functions.reading.readme import find_readme, read_readme
from rtron.functions.reading.skipped import Note, Skipped, kept
from rtron.functions.repository import Package, Repository

MAX_FOLDERS = 200_000
MAX_PACKAGES = 2000
_IGNORED = frozenset({"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"})


def read_folders(top: Path, note: Note) -> Iterator[Repository]:
    """Yield the repository in a folder, or those in its folders; what cannot be read is noted."""
    for folder in repository_folders(top):
        repository = _repository(folder, note)
        if repository.packages:
            yield repository
        else:
            note(Skipped(place=str(folder), why=f"has no {MANIFEST}"))


def repository_folders(top: Path) -> list[Path]:
    """Return `top` if it is one repository, else its folders.

    It is one if it has .git or a package.xml, or a README and no folder in it has .git.
    """
    inside = _folders(top)
    alone = _has(top, ".git") or _has(top, MANIFEST)
    several = any(_has(folder, ".git") for folder in inside)
    return [top] if alone or (find_readme(top) and not several) else inside


def _folders(top: Path) -> list[Path]:
    try:
        return sorted(path for path in top.iterdir() if path.is_dir() and path.name[0] != ".")
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(top)) from None


def _has(folder: Path, name: str) -> bool:
    return (folder / name).exists()


def _repository(folder: Path, note: Note) -> Repository:
    places = list(islice(_package_folders(folder), MAX_PACKAGES + 1))
    if len(places) > MAX_PACKAGES:
        why = f"has more than {MAX_PACKAGES} packages; the others are left out"
        note(Skipped(place=str(folder), why=why))
    packages = tuple(_packages(places[:MAX_PACKAGES], note))
    homes = dict.fromkeys([folder, *(places if len(places) == 1 else ())])
    readme = next(filter(None, (read_readme(home, note) for home in homes)), "")
    name = folder.resolve().name[:MAX_NAME] or "/"
    return Repository(name=name, packages=packages, readme=readme)


def _packages(places: list[Path], note: Note) -> Iterator[Package]:
    read = (kept(note, str(place / MANIFEST), read_package, place) for place in places)
    return (package for package in read if package is not None)


def _package_folders(top: Path) -> Iterator[Path]:
    """Yield the folders with a package.xml, as a build finds them: packages do not nest."""
    for number, (folder, subfolders, files) in enumerate(os.walk(top)):
        if number == MAX_FOLDERS:
            raise InputError(f"has more than {MAX_FOLDERS} folders", path=str(top))
        ignored = not _IGNORED.isdisjoint(files)
        if MANIFEST in files and not ignored:
            yield Path(folder)
        if MANIFEST in files or ignored:
            subfolders.clear()
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
