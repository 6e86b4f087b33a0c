"""A model's YAML file, read safely and checked; every fault names the file and the line."""

from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded

T = TypeVar("T", bound=BaseModel)

MAX_BYTES = 2**20
MAX_DEPTH = 20
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_SHOWN = 60


def read_form(path: Path, form: type[T]) -> T:
    """Return what a YAML file says, as `form`; raise InputError with its line where it is wrong."""
    root = compose(path)
    try:
        return form.model_validate(plain(root, path))
    except ValidationError as error:
        raise _fault(error, root, path, form) from None


def compose(path: Path) -> yaml.Node:
    """Return the tree of a YAML file; raise InputError if it is none, too large or too deep."""
    data = read_bounded(path, MAX_BYTES)
    try:
        _refuse_unsafe(data, path)
        root = yaml.compose(data, Loader=_LOADER)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 0
        raise InputError(f"not YAML: {error.problem}", path=str(path), line=line) from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(f"not YAML: {error}", path=str(path)) from None
    if root is None:
        raise InputError("the file is empty", path=str(path))
    return root


def plain(root: yaml.Node, path: Path) -> Any:  # noqa: ANN401 - any YAML value
    """Return the values of a YAML tree; raise InputError if one cannot be made."""
    loader = _LOADER("")
    try:
        return loader.construct_document(root)
    except (yaml.YAMLError, ValueError, TypeError) as error:
        raise InputError(f"not YAML: {error}", path=str(path)) from None
    finally:
        loader.dispose()


def _refuse_unsafe(data: bytes, path: Path) -> None:
    depth = 0
    for event in yaml.parse(data, Loader=_LOADER):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if isinstance(event, yaml.AliasEvent) or depth > MAX_DEPTH:
            line = event.start_mark.line + 1 if event.start_mark else 0
            raise InputError("aliases and deep nesting are refused", path=str(path), line=line)


def _fault(error: ValidationError, root: yaml.Node, path: Path, form: type[T]) -> InputError:
    fault = error.errors(include_url=False)[0]
    place = [part for part in fault["loc"] if part != "[key]"]
    line = _line(root, place)
    where = ".".join(str(part) for part in place)
    message = f"{where}: {fault['msg']}"[:200]
    return InputError(message, path=str(path), line=line, help=_help(place, form))


def _line(node: yaml.Node, place: list[Any]) -> int:
    line = int(node.start_mark.line) + 1
    for part in place:
        step = _step(node, part)
        if step is None:
            return line
        line, node = step
    return line


def _step(node: yaml.Node, part: object) -> tuple[int, yaml.Node] | None:
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int):
        return int(node.value[part].start_mark.line) + 1, node.value[part]
    if not isinstance(node, yaml.MappingNode):
        return None
    found = ((key, value) for key, value in node.value if key.value == part)
    return next(((int(key.start_mark.line) + 1, value) for key, value in found), None)


def _help(place: list[Any], form: type[BaseModel]) -> str:
    known = form.model_json_schema()
    keys = [*known.get("properties", {})]
    for definition in known.get("$defs", {}).values():
        keys += definition.get("properties", {})
    near = get_close_matches(str(place[-1] if place else "")[:_SHOWN], keys, n=1)
    return f"did you mean {near[0]}?" if near and near[0] not in place else "see docs/models.md"
