"""A model's YAML file, read safely and checked; every fault names the file and the line."""

from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from rtron.errors import InputError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.yaml_safety import SAFE_LOADER, YamlRules, yaml_errors
from rtron.yaml_safety import compose_yaml as safe_tree

T = TypeVar("T", bound=BaseModel)

MAX_BYTES = 2**20
_YAML_RULES = YamlRules(max_depth=20)
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
    root = safe_tree(read_bounded(path, MAX_BYTES), str(path), _YAML_RULES)
    if root is None:
        raise InputError("the file is empty", path=str(path))
    return root


def construct_value(root: yaml.Node, path: Path) -> Any:  # noqa: ANN401 - any YAML value
    """Return the values of a YAML tree; raise InputError if one cannot be made."""
    loader = SAFE_LOADER("")
    try:
        with yaml_errors(str(path)):
            return loader.construct_document(root)
    finally:
        loader.dispose()


def _model_error(
    error: ValidationError, root: yaml.Node, path: Path, schema: type[T]
) -> InputError:
    details = error.errors(include_url=False)[0]
    path_keys = [part for part in details["loc"] if part != "[key]"]
    line = _line(root, path_keys)
    dotted_path = ".".join(str(part) for part in path_keys)
    message = f"{dotted_path}: {plain_reason(details['msg'])}"[:200]
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
