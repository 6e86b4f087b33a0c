"""Repositories from wherever they are described, each of them once."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.reading.corpus import read_corpus, read_readmes
from rtron.functions.reading.skipped_entries import Note, Noting, Skipped
from rtron.functions.repository import Repository
from rtron.sources.bounded_file import STDIN

MAX_REPOSITORIES = 20_000
MAX_PACKAGES = 200_000
_YAML = frozenset({".yaml", ".yml"})
Reader: TypeAlias = Callable[[Path, Note], Iterator[Repository]]


def read_repositories(path: Path, readmes: Path | None, note: Note) -> list[Repository]:
    """Return the repositories of a corpus, a folder, or a distribution.yaml of rosdistro.

    `readmes` is a file with READMEs for those that have none. What is left out goes to `note`.
    Raise InputError if nothing can be read, or there are more than MAX_REPOSITORIES,
    or MAX_PACKAGES in them.
    """
    texts = read_readmes(readmes, Noting(note)) if readmes else {}
    noting = Noting(note)
    read, shape = _reader(path)
    found = list(_bounded(_once(read(path, noting), path, noting), path))
    if not found:
        help = str(noting.first or shape)
        raise InputError("no repository could be read", path=str(path), help=help)
    return [each if each.readme else _with_readme(each, texts) for each in found]


def _reader(path: Path) -> tuple[Reader, str]:
    """Return what reads a path, and what it would read."""
    if path != STDIN and is_folder(path):
        from rtron.functions.reading.folder import read_folders  # noqa: PLC0415 - XML is not always needed

        return read_folders, "a repository has a package.xml in it or below"
    if path.suffix.lower() in _YAML:
        from rtron.functions.reading.distribution import read_distribution  # noqa: PLC0415 - nor is YAML

        return read_distribution, "a distribution.yaml has `repositories` with their names"
    return read_corpus, "a line is an object with `repo` and `packages`"


def _bounded(found: Iterable[Repository], path: Path) -> Iterator[Repository]:
    packages = 0
    for number, each in enumerate(found):
        packages += len(each.packages)
        if number == MAX_REPOSITORIES:
            raise InputError(f"has more than {MAX_REPOSITORIES} repositories", path=str(path))
        if packages > MAX_PACKAGES:
            raise InputError(f"has more than {MAX_PACKAGES} packages", path=str(path))
        yield each


def _once(found: Iterable[Repository], path: Path, note: Note) -> Iterator[Repository]:
    seen: set[str] = set()
    for each in found:
        if each.name in seen:
            note(Skipped(place=str(path), why=f"{each.name} is there twice; the first counts"))
        else:
            seen.add(each.name)
            yield each


def _with_readme(repository: Repository, texts: dict[str, str]) -> Repository:
    readme = texts.get(repository.name)
    return replace(repository, readme=readme) if readme else repository
