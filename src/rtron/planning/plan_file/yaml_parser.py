"""YAML from anywhere, taken apart: bounded in size and depth, without aliases, anchors and tags."""

from pathlib import Path
from typing import Any

import yaml

from rtron.errors import PlanError

MAX_BYTES = 2**20
MAX_DEPTH = 20
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_text(path: Path) -> str:
    """Return a plan's text; raise PlanError if it cannot be read or is too large."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise PlanError(why, path=str(path), help="`rtron plan` writes one") from None
    except UnicodeDecodeError:
        raise PlanError("not UTF-8 text", path=str(path)) from None
    if len(data) > MAX_BYTES:
        raise PlanError(f"larger than {MAX_BYTES} bytes", path=str(path))
    return text


def parse_yaml(text: str, path: str) -> yaml.Node:
    """Return the tree of a YAML text with its lines; raise PlanError if it is none or unsafe."""
    try:
        _refuse_unsafe(text, path)
        root = yaml.compose(text, Loader=_LOADER)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 0
        raise PlanError(f"not YAML: {error.problem}", path=path, line=line) from None
    except (yaml.YAMLError, ValueError) as error:
        raise PlanError(f"not YAML: {error}", path=path) from None
    if root is None:
        raise PlanError("the plan is empty", path=path, help="`rtron plan` writes one")
    return root


def _refuse_unsafe(text: str, path: str) -> None:
    depth = 0
    for event in yaml.parse(text, Loader=_LOADER):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        unsafe = _unsafe(event, depth)
        if unsafe:
            line = event.start_mark.line + 1 if event.start_mark else 0
            raise PlanError(f"a plan has no {unsafe}", path=path, line=line)


def _unsafe(event: yaml.Event, depth: int) -> str:
    if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
        return "anchors and aliases"
    if getattr(event, "tag", None):
        return "tags (`!…`)"
    return f"more than {MAX_DEPTH} levels" if depth > MAX_DEPTH else ""
