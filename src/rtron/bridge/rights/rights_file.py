"""Reading `bridge.yaml`: all that is wrong with it at once, each fault with its line."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml
from pydantic import ValidationError

from rtron.bridge.rights.document import RIGHTS, BridgeRights
from rtron.errors import InputError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.yaml_safety import SAFE_LOADER, YamlRules, compose_yaml, yaml_errors

MAX_BYTES = 1 << 20
_RULES = YamlRules(max_depth=10, max_values=50_000, allows_tags=False, refusal="the rights have no")
_HELP = "`rtron schema bridge` describes every key"
_MAX_SHOWN = 20


def read_rights(path: Path) -> BridgeRights:
    """Read the rights of a bridge's clients; InputError, with lines, if they are wrong."""
    return parse_rights(read_bounded(path, MAX_BYTES), str(path))


def parse_rights(text: bytes | str, path: str = "bridge.yaml") -> BridgeRights:
    """Read rights from their text; `path` is what the errors call it."""
    root = compose_yaml(text, path, _RULES)
    if root is None:
        raise InputError("the file is empty", path=path, help=_HELP)
    _check_keys(root, path)
    with yaml_errors(path):
        document = json.dumps(yaml.load(text, Loader=SAFE_LOADER), default=str)  # noqa: S506 - a safe one
    try:
        return RIGHTS.validate_json(document)
    except ValidationError as error:
        raise _file_error(error, root, path) from None


def _check_keys(node: yaml.Node, path: str) -> None:
    """Refuse a key that stands twice, of which YAML would silently take the last."""
    children = [node]
    while children:
        each = children.pop()
        if isinstance(each, yaml.SequenceNode):
            children += each.value
        elif isinstance(each, yaml.MappingNode):
            keys: set[str] = set()
            for key, value in each.value:
                if str(key.value) in keys:
                    message = f"{key.value} stands twice"
                    raise InputError(message, path=path, line=_line(key), help=_HELP)
                keys.add(str(key.value))
                children.append(value)


def _file_error(error: ValidationError, root: yaml.Node, path: str) -> InputError:
    faults = sorted(
        {
            (_line_of(root, each["loc"]), f"{_place(each['loc'])}: {_message(each)}")
            for each in error.errors(include_url=False)
        }
    )
    (line, first), *others = faults[:_MAX_SHOWN]
    text = "\n".join([first, *(f"{path}:{number}: {each}" for number, each in others)])
    return InputError(text, path=path, line=line, help=_HELP)


def _line_of(root: yaml.Node, location: Sequence[str | int]) -> int:
    """Return the line of a place in the document, or of what is around it."""
    node, line = root, 1
    for part in location:
        found = _child(node, part)
        if found is None:
            break
        line, node = found
    return line


def _child(node: yaml.Node, part: str | int) -> tuple[int, yaml.Node] | None:
    if isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
        return _line(node.value[part]), node.value[part]
    if isinstance(node, yaml.MappingNode):
        return next(((_line(key), value) for key, value in node.value if key.value == part), None)
    return None


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


def _place(location: Sequence[str | int]) -> str:
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return "".join(parts).removeprefix(".") or "the file"


def _message(details: Mapping[str, Any]) -> str:
    if details["type"] == "missing":
        return "is missing"
    if details["type"] == "extra_forbidden":
        return "is not a key that is known here"
    return plain_reason(details["msg"]).replace("Input should", "it should")
