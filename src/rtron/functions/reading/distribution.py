"""A distribution.yaml of rosdistro: the names of repositories and of their packages (REP 143)."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from rtron.errors import InputError
from rtron.functions.reading import fields
from rtron.functions.reading.json_lines import Document
from rtron.functions.reading.skipped_entries import SkippedHandler, read_or_skip
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.bounded_file import read_bounded

MAX_BYTES = 4 * 2**20
MAX_EVENTS = 250_000
MAX_DEPTH = 20
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(path: Path) -> object:
    """Return the document in a file; raise InputError if it is none, or not safe to read."""
    data = read_bounded(path, MAX_BYTES)
    try:
        _refuse_unsafe(data, path)
        return yaml.load(data, Loader=_LOADER)  # noqa: S506 - it is a safe loader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 0
        raise InputError(f"not YAML: {error.problem}", path=str(path), line=line) from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(f"not YAML: {error}", path=str(path)) from None


def _refuse_unsafe(data: bytes, path: Path) -> None:
    depth = 0
    for number, event in enumerate(yaml.parse(data, Loader=_LOADER)):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        unsafe = _unsafe_feature(event, depth, number)
        if unsafe:
            line = event.start_mark.line + 1 if event.start_mark else 0
            help = "is it a distribution.yaml?"
            raise InputError(f"has {unsafe}", path=str(path), line=line, help=help)


def _unsafe_feature(event: yaml.Event, depth: int, number: int) -> str:
    if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
        return "anchors or aliases, which are not read"
    if getattr(event, "tag", None):
        return "tags (`!…`), which are not read"
    if number == MAX_EVENTS:
        return f"more than {MAX_EVENTS} values"
    return f"more than {MAX_DEPTH} levels" if depth > MAX_DEPTH else ""


_SECTIONS = ("source", "doc", "release")


def read_distribution(path: Path, on_skipped: SkippedHandler) -> Iterator[SourceRepository]:
    """Yield the repositories that a distribution lists; a wrong entry goes to `on_skipped`."""
    document = read_yaml(path)
    listed = document.get("repositories") if isinstance(document, dict) else None
    if not isinstance(listed, dict):
        help = "give a distribution.yaml of rosdistro, a corpus in JSON lines, or a folder"
        raise InputError("lists no repositories", path=str(path), help=help)
    for name, entry in listed.items():
        location = f"{path}: {str(name)[: fields.MAX_NAME]}"
        repository = read_or_skip(
            on_skipped, location, _repository, {"repo": name, "entry": entry}, location, on_skipped
        )
        if repository is not None:
            yield repository


def _repository(listed: Document, location: str, on_skipped: SkippedHandler) -> SourceRepository:
    name, entry = (
        fields.required_name(listed, "repo"),
        fields.required_object(listed["entry"], "the entry"),
    )
    sections = {key: fields.required_object(entry[key], key) for key in _SECTIONS if entry.get(key)}
    urls = (fields.optional_text(section, "url") for section in sections.values())
    packages = fields.first_packages(_packages(name, sections), location, on_skipped)
    return SourceRepository(
        name=name,
        packages=tuple(SourcePackage(name=each) for each in packages),
        url=next(filter(None, urls), ""),
    )


def _packages(name: str, sections: dict[str, Document]) -> list[str]:
    """Return the released packages; the one package of a release has its repository's name."""
    if "release" not in sections:
        return []
    listed = fields.optional_list(sections["release"], "packages")
    return [fields.required_name({"a package": each}, "a package") for each in listed] or [name]
