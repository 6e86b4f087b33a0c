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
_YAML_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_MAX_SHOWN = 60


def read_model(path: Path, schema: type[T]) -> T:
    """Return a YAML file as `schema`; raise InputError with its line where it is wrong."""
    root = compose_yaml(path)
    try:
        return schema.model_validate(construct_value(root, path))
    except ValidationError as error:
        raise _model_error(error, root, path, schema) from None


def compose_yaml(path: Path) -> yaml.Node:
    """Return the tree of a YAML file; raise InputError if it is none, too large or too deep."""
    data = read_bounded(path, MAX_BYTES)
    try:
        _refuse_unsafe(data, path)
        root = yaml.compose(data, Loader=_YAML_LOADER)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 0
        raise InputError(f"not YAML: {error.problem}", path=str(path), line=line) from None
    except (yaml.YAMLError, ValueError) as error:
        raise InputError(f"not YAML: {error}", path=str(path)) from None
    if root is None:
        raise InputError("the file is empty", path=str(path))
    return root


def construct_value(root: yaml.Node, path: Path) -> Any:  # noqa: ANN401 - any YAML value
    """Return the values of a YAML tree; raise InputError if one cannot be made."""
    loader = _YAML_LOADER("")
    try:
        return loader.construct_document(root)
    except (yaml.YAMLError, ValueError, TypeError) as error:
        raise InputError(f"not YAML: {error}", path=str(path)) from None
    finally:
        loader.dispose()


def _refuse_unsafe(data: bytes, path: Path) -> None:
    depth = 0
    for event in yaml.parse(data, Loader=_YAML_LOADER):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if isinstance(event, yaml.AliasEvent) or depth > MAX_DEPTH:
            line = event.start_mark.line + 1 if event.start_mark else 0
            raise InputError("aliases and deep nesting are refused", path=str(path), line=line)


def _model_error(
    error: ValidationError, root: yaml.Node, path: Path, schema: type[T]
) -> InputError:
    details = error.errors(include_url=False)[0]
    path_keys = [part for part in details["loc"] if part != "[key]"]
    line = _line(root, path_keys)
    dotted_path = ".".join(str(part) for part in path_keys)
    message = f"{dotted_path}: {details['msg']}"[:200]
    return InputError(message, path=str(path), line=line, help=_help(path_keys, schema))


def _line(node: yaml.Node, path_keys: list[Any]) -> int:
    line = int(node.start_mark.line) + 1
    for part in path_keys:
        step = _child_node(node, part)
        if step is None:
            return line
        line, node = step
    return line


def _child_node(node: yaml.Node, part: object) -> tuple[int, yaml.Node] | None:
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int):
        return int(node.value[part].start_mark.line) + 1, node.value[part]
    if not isinstance(node, yaml.MappingNode):
        return None
    matches = ((key, value) for key, value in node.value if key.value == part)
    return next(((int(key.start_mark.line) + 1, value) for key, value in matches), None)


def _help(path_keys: list[Any], schema: type[BaseModel]) -> str:
    known = schema.model_json_schema()
    keys = [*known.get("properties", {})]
    for definition in known.get("$defs", {}).values():
        keys += definition.get("properties", {})
    matches = get_close_matches(str(path_keys[-1] if path_keys else "")[:_MAX_SHOWN], keys, n=1)
    return (
        f"did you mean {matches[0]}?"
        if matches and matches[0] not in path_keys
        else "see docs/models.md"
    )
