"""Repositories from wherever they are described, each of them once."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path

from rtron.errors import InputError
from rtron.functions.reading.corpus import read_corpus, read_readmes
from rtron.functions.reading.skipped import Note, Noting, Skipped
from rtron.functions.repository import Repository
from rtron.sources.bounded import STDIN

MAX_REPOSITORIES = 20_000
_YAML = frozenset({".yaml", ".yml"})


def read_repositories(path: Path, readmes: Path | None, note: Note) -> list[Repository]:
    """Return the repositories of a corpus, a folder, or a distribution.yaml of rosdistro.

    `readmes` is a file with READMEs for those that have none. What is left out goes to `note`.
    Raise InputError if nothing can be read, or there are more than MAX_REPOSITORIES.
    """
    texts = read_readmes(readmes, Noting(note)) if readmes else {}
    noting = Noting(note)
    found = list(islice(_once(_read(path, noting), path, noting), MAX_REPOSITORIES + 1))
    if len(found) > MAX_REPOSITORIES:
        raise InputError(f"has more than {MAX_REPOSITORIES} repositories", path=str(path))
    if not found:
        help = str(noting.first or "a line is an object with `repo` and `packages`")
        raise InputError("no repository could be read", path=str(path), help=help)
    return [each if each.readme else _with_readme(each, texts) for each in found]


def _read(path: Path, note: Note) -> Iterator[Repository]:
    if path != STDIN and path.is_dir():
        from rtron.functions.reading.folder import read_folders  # noqa: PLC0415 - XML is not always needed

        return read_folders(path, note)
    if path.suffix.lower() in _YAML:
        from rtron.functions.reading.distribution import read_distribution  # noqa: PLC0415 - nor is YAML

        return read_distribution(path, note)
    return read_corpus(path, note)


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
