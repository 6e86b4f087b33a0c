"""Repositories from wherever they are described, each of them once.

A corpus is a file with a line of JSON for each repository, and one with their READMEs. A line of
the first: `{"repo", "url", "packages": [{"name", "description", "depends"}], "readme"}`; all but
`repo` may be absent. A package that says `"placeholder": true` has a description that says
nothing. A line of the second: `{"repo", "readme"}`. Other keys are not looked at.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.folders import is_folder
from rtron.functions.reading import json_lines
from rtron.functions.reading.json_lines import Document, read_json_lines
from rtron.functions.reading.skipped_entries import (
    SkippedCounter,
    SkippedEntry,
    SkippedHandler,
    UnreadableEntryError,
    read_or_skip,
)
from rtron.functions.repository import SourcePackage, SourceRepository
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


def read_corpus(path: Path, on_skipped: SkippedHandler) -> Iterator[SourceRepository]:
    """Yield the repositories of a corpus; a wrong line goes to `on_skipped`."""
    for location, document in read_json_lines(path, on_skipped):
        repository = read_or_skip(on_skipped, location, _entry, document, location, on_skipped)
        if repository is not None:
            yield repository


def read_readmes(path: Path, on_skipped: SkippedHandler) -> dict[str, str]:
    """Return READMEs by their repositories' names; of two the first counts."""
    readmes: dict[str, str] = {}
    for location, document in read_json_lines(path, on_skipped):
        entry = read_or_skip(on_skipped, location, _readme, document)
        if entry is not None:
            readmes.setdefault(*entry)
    return readmes


def _readme(document: Document) -> tuple[str, str]:
    return json_lines.required_name(document, "repo"), json_lines.optional_text(document, "readme")


def _entry(document: Document, location: str, on_skipped: SkippedHandler) -> SourceRepository:
    packages = json_lines.first_packages(
        json_lines.optional_list(document, "packages"), location, on_skipped
    )
    return SourceRepository(
        name=json_lines.required_name(document, "repo"),
        packages=tuple(map(_package, packages)),
        readme=json_lines.optional_text(document, "readme"),
        url=json_lines.optional_text(document, "url"),
    )


def _package(entry: object) -> SourcePackage:
    document = json_lines.required_object(entry, "a package")
    is_placeholder = document.get("placeholder") is True
    depends = json_lines.optional_list(document, "depends")
    if not all(isinstance(each, str) for each in depends):
        raise UnreadableEntryError("depends holds what is no text")
    return SourcePackage(
        name=json_lines.required_name(document, "name"),
        description="" if is_placeholder else json_lines.optional_text(document, "description"),
        depends=tuple(depends),
    )
