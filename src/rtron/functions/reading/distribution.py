"""A distribution.yaml of rosdistro: the names of repositories and of their packages (REP 143)."""

from collections.abc import Iterator
from pathlib import Path

import yaml

from rtron.errors import InputError
from rtron.functions.reading import json_lines
from rtron.functions.reading.json_lines import Document
from rtron.functions.reading.skipped_entries import SkippedHandler, read_or_skip
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.bounded_file import read_bounded
from rtron.yaml_safety import SAFE_LOADER, YamlRules, check_yaml, yaml_errors

MAX_BYTES = 4 * 2**20
YAML_RULES = YamlRules(
    max_depth=20, max_values=250_000, allows_tags=False, help="is it a distribution.yaml?"
)


def read_yaml(path: Path) -> object:
    """Return the document in a file; raise InputError if it is none, or not safe to read."""
    data = read_bounded(path, MAX_BYTES)
    with yaml_errors(str(path)):
        check_yaml(data, str(path), YAML_RULES)
        return yaml.load(data, Loader=SAFE_LOADER)  # noqa: S506 - it is a safe loader


_SECTIONS = ("source", "doc", "release")


def read_distribution(path: Path, on_skipped: SkippedHandler) -> Iterator[SourceRepository]:
    """Yield the repositories that a distribution lists; a wrong entry goes to `on_skipped`."""
    document = read_yaml(path)
    listed = document.get("repositories") if isinstance(document, dict) else None
    if not isinstance(listed, dict):
        help = "give a distribution.yaml of rosdistro, a corpus in JSON lines, or a folder"
        raise InputError("lists no repositories", path=str(path), help=help)
    for name, entry in listed.items():
        location = f"{path}: {str(name)[: json_lines.MAX_NAME]}"
        repository = read_or_skip(
            on_skipped,
            location,
            _listed_entry,
            {"repo": name, "entry": entry},
            location,
            on_skipped,
        )
        if repository is not None:
            yield repository


def _listed_entry(listed: Document, location: str, on_skipped: SkippedHandler) -> SourceRepository:
    name, entry = (
        json_lines.required_name(listed, "repo"),
        json_lines.required_object(listed["entry"], "the entry"),
    )
    sections = {
        key: json_lines.required_object(entry[key], key) for key in _SECTIONS if entry.get(key)
    }
    urls = (json_lines.optional_text(section, "url") for section in sections.values())
    packages = json_lines.first_packages(_packages(name, sections), location, on_skipped)
    return SourceRepository(
        name=name,
        packages=tuple(SourcePackage(name=each) for each in packages),
        url=next(filter(None, urls), ""),
    )


def _packages(name: str, sections: dict[str, Document]) -> list[str]:
    """Return the released packages; the one package of a release has its repository's name."""
    if "release" not in sections:
        return []
    listed = json_lines.optional_list(sections["release"], "packages")
    return [json_lines.required_name({"a package": each}, "a package") for each in listed] or [name]
