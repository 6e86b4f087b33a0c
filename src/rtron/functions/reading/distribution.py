"""A distribution.yaml of rosdistro: the names of repositories and of their packages (REP 143)."""

from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.functions.reading import fields
from rtron.functions.reading.json_lines import Document
from rtron.functions.reading.skipped_entries import Note, kept
from rtron.functions.reading.yaml_file import read_yaml
from rtron.functions.repository import Package, Repository

_SECTIONS = ("source", "doc", "release")


def read_distribution(path: Path, note: Note) -> Iterator[Repository]:
    """Yield the repositories that a distribution lists; a wrong entry goes to `note`."""
    document = read_yaml(path)
    listed = document.get("repositories") if isinstance(document, dict) else None
    if not isinstance(listed, dict):
        help = "give a distribution.yaml of rosdistro, a corpus in JSON lines, or a folder"
        raise InputError("lists no repositories", path=str(path), help=help)
    for name, entry in listed.items():
        place = f"{path}: {str(name)[: fields.MAX_NAME]}"
        repository = kept(note, place, _repository, {"repo": name, "entry": entry}, place, note)
        if repository is not None:
            yield repository


def _repository(listed: Document, place: str, note: Note) -> Repository:
    name, entry = fields.name(listed, "repo"), fields.mapping(listed["entry"], "the entry")
    sections = {key: fields.mapping(entry[key], key) for key in _SECTIONS if entry.get(key)}
    urls = (fields.text(section, "url") for section in sections.values())
    packages = fields.first_packages(_packages(name, sections), place, note)
    return Repository(
        name=name,
        packages=tuple(Package(name=each) for each in packages),
        url=next(filter(None, urls), ""),
    )


def _packages(name: str, sections: dict[str, Document]) -> list[str]:
    """Return the released packages; the one package of a release has its repository's name."""
    if "release" not in sections:
        return []
    listed = fields.entries(sections["release"], "packages")
    return [fields.name({"a package": each}, "a package") for each in listed] or [name]
