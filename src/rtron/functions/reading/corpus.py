"""A corpus: a file with a line of JSON for each repository, and one with their READMEs.

A line of the first: `{"repo", "url", "packages": [{"name", "description", "depends"}], "readme"}`;
all but `repo` may be absent. A package that says `"placeholder": true` has a description that
says nothing. A line of the second: `{"repo", "readme"}`. Other keys are not looked at.
"""

from collections.abc import Iterator
from pathlib import Path

from rtron.functions.reading import fields
from rtron.functions.reading.json_lines import Document, json_lines
from rtron.functions.reading.skipped_entries import Note, UnreadableError, kept
from rtron.functions.repository import Package, Repository


def read_corpus(path: Path, note: Note) -> Iterator[Repository]:
    """Yield the repositories of a corpus; a wrong line goes to `note`."""
    for place, document in json_lines(path, note):
        repository = kept(note, place, _repository, document, place, note)
        if repository is not None:
            yield repository


def read_readmes(path: Path, note: Note) -> dict[str, str]:
    """Return READMEs by their repositories' names; of two the first counts."""
    found: dict[str, str] = {}
    for place, document in json_lines(path, note):
        entry = kept(note, place, _readme, document)
        if entry is not None:
            found.setdefault(*entry)
    return found


def _readme(document: Document) -> tuple[str, str]:
    return fields.name(document, "repo"), fields.text(document, "readme")


def _repository(document: Document, place: str, note: Note) -> Repository:
    packages = fields.first_packages(fields.entries(document, "packages"), place, note)
    return Repository(
        name=fields.name(document, "repo"),
        packages=tuple(map(_package, packages)),
        readme=fields.text(document, "readme"),
        url=fields.text(document, "url"),
    )


def _package(entry: object) -> Package:
    document = fields.mapping(entry, "a package")
    says_nothing = document.get("placeholder") is True
    depends = fields.entries(document, "depends")
    if not all(isinstance(each, str) for each in depends):
        raise UnreadableError("depends holds what is no text")
    return Package(
        name=fields.name(document, "name"),
        description="" if says_nothing else fields.text(document, "description"),
        depends=tuple(depends),
    )
