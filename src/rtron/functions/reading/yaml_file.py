"""A YAML file from anywhere: bounded in size, depth and number, no anchors, aliases, tags."""

from pathlib import Path
from typing import Any

import yaml

from rtron.errors import InputError
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
