"""A corpus: a file with a line of JSON for each repository, and one with their READMEs.

A line of the first: `{"repo", "url", "packages": [{"name", "description", "depends"}], "readme"}`;
all but `repo` may be absent. A package that says `"placeholder": true` has a description that
says nothing. A line of the second: `{"repo", "readme"}`. Other keys are not looked at.
"""

from collections.abc import Iterator
from pathlib import Path

from rtron.functions.reading import fields
from rtron.functions.reading.json_lines import Document, read_json_lines
from rtron.functions.reading.skipped_entries import (
    SkippedHandler,
    UnreadableEntryError,
    read_or_skip,
)
from rtron.functions.repository import SourcePackage, SourceRepository


def read_corpus(path: Path, on_skipped: SkippedHandler) -> Iterator[SourceRepository]:
    """Yield the repositories of a corpus; a wrong line goes to `on_skipped`."""
    for location, document in read_json_lines(path, on_skipped):
        repository = read_or_skip(on_skipped, location, _repository, document, location, on_skipped)
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
    return fields.required_name(document, "repo"), fields.optional_text(document, "readme")


def _repository(document: Document, location: str, on_skipped: SkippedHandler) -> SourceRepository:
    packages = fields.first_packages(
        fields.optional_list(document, "packages"), location, on_skipped
    )
    return SourceRepository(
        name=fields.required_name(document, "repo"),
        packages=tuple(map(_package, packages)),
        readme=fields.optional_text(document, "readme"),
        url=fields.optional_text(document, "url"),
    )


def _package(entry: object) -> SourcePackage:
    document = fields.required_object(entry, "a package")
    is_placeholder = document.get("placeholder") is True
    depends = fields.optional_list(document, "depends")
    if not all(isinstance(each, str) for each in depends):
        raise UnreadableEntryError("depends holds what is no text")
    return SourcePackage(
        name=fields.required_name(document, "name"),
        description="" if is_placeholder else fields.optional_text(document, "description"),
        depends=tuple(depends),
    )
