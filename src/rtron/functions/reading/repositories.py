"""Repositories from wherever they are described, each of them once."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.reading.corpus import read_corpus, read_readmes
from rtron.functions.reading.skipped_entries import SkippedCounter, SkippedEntry, SkippedHandler
from rtron.functions.repository import SourceRepository
from rtron.sources.bounded_file import STDIN

MAX_REPOSITORIES = 20_000
MAX_PACKAGES = 200_000
_YAML = frozenset({".yaml", ".yml"})
RepositoryReader: TypeAlias = Callable[[Path, SkippedHandler], Iterator[SourceRepository]]


def read_repositories(
    path: Path, readmes: Path | None, on_skipped: SkippedHandler
) -> list[SourceRepository]:
    """Return the repositories of a corpus, a folder, or a distribution.yaml of rosdistro.

    `readmes` is a file with READMEs for those that have none. What is left out goes to
    `on_skipped`. Raise InputError if nothing can be read, or there are more than MAX_REPOSITORIES,
    or MAX_PACKAGES in them.
    """
    texts = read_readmes(readmes, SkippedCounter(on_skipped)) if readmes else {}
    counter = SkippedCounter(on_skipped)
    read, shape = _choose_reader(path)
    repositories = list(
        _check_limits(_without_duplicates(read(path, counter), path, counter), path)
    )
    if not repositories:
        help = str(counter.first or shape)
        raise InputError("no repository could be read", path=str(path), help=help)
    return [each if each.readme else _with_readme(each, texts) for each in repositories]


def _choose_reader(path: Path) -> tuple[RepositoryReader, str]:
    """Return what reads a path, and what it would read."""
    if path != STDIN and is_folder(path):
        from rtron.functions.reading.folder import read_folders  # noqa: PLC0415 - XML is not always needed

        return read_folders, "a repository has a package.xml in it or below"
    if path.suffix.lower() in _YAML:
        from rtron.functions.reading.distribution import read_distribution  # noqa: PLC0415 - nor is YAML

        return read_distribution, "a distribution.yaml has `repositories` with their names"
    return read_corpus, "a line is an object with `repo` and `packages`"


def _check_limits(
    repositories: Iterable[SourceRepository], path: Path
) -> Iterator[SourceRepository]:
    packages = 0
    for number, each in enumerate(repositories):
        packages += len(each.packages)
        if number == MAX_REPOSITORIES:
            raise InputError(f"has more than {MAX_REPOSITORIES} repositories", path=str(path))
        if packages > MAX_PACKAGES:
            raise InputError(f"has more than {MAX_PACKAGES} packages", path=str(path))
        yield each


def _without_duplicates(
    repositories: Iterable[SourceRepository], path: Path, on_skipped: SkippedHandler
) -> Iterator[SourceRepository]:
    seen: set[str] = set()
    for each in repositories:
        if each.name in seen:
            on_skipped(
                SkippedEntry(
                    location=str(path), reason=f"{each.name} is there twice; the first counts"
                )
            )
        else:
            seen.add(each.name)
            yield each


def _with_readme(repository: SourceRepository, texts: dict[str, str]) -> SourceRepository:
    readme = texts.get(repository.name)
    return replace(repository, readme=readme) if readme else repository
