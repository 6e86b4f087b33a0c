"""A file that a node reads itself, named by a parameter or an argument."""

import re
from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.sources.code.library_models.rclcpp.behavior_tree_xml import (
    BUILT_IN_NODES,
    read_tree_nodes,
)
from rtron.sources.models.common.values import Placeholder, Value, has_placeholder, placeholder
from rtron.sources.models.common.yaml_model import MAX_BYTES, compose_yaml, construct_value

_LUA_COMMENT = re.compile(r"--\[\[.*?(?:\]\]|\Z)|--[^\n]*", re.DOTALL)
_LUA_LINE = re.compile(
    r"\binclude(?:\s*\()?\s*[\"'](?P<file>\w[\w.-]*)[\"']"
    r"|(?<![\w.])(?P<name>[A-Za-z_][\w.]*)\s*=(?!=)\s*"
    r"(?P<value>\"[^\"\n]*\"|'[^'\n]*'|[^\s,;{}]*)"
)
_LUA_NUMBER = re.compile(r"-?[0-9]{1,15}(?:\.[0-9]{0,15})?(?:[eE][+-]?[0-9]{1,2})?", re.ASCII)
_MAX_LUA_FILES = 64
_LUA_LITERALS = {"true": True, "false": False}


def read_yaml_file(path: Value) -> Value:
    """Return what a YAML file holds; a hole if it cannot be read."""
    if isinstance(path, Placeholder) or has_placeholder(path):
        return placeholder(f"yaml_file {path}")
    file = Path(str(path))
    if not file.is_file():
        return placeholder(f"yaml_file {file.name}")
    try:
        return construct_value(compose_yaml(file), file)
    except InputError:
        return placeholder(f"yaml_file {file.name}")


def read_lua_setting(folder: Value, name: Value, key: str, default: Value = None) -> Value:
    """Return what a Lua file of settings assigns last to a name that ends with `key`.

    The file is not run: a value that is no literal is a hole. Files that it includes count if they
    lie in the same folder (google-cartographer.readthedocs.io: Lua configuration reference).
    """
    if not folder or not name or has_placeholder(folder) or has_placeholder(name):
        return default
    return dict(_lua_assignments(Path(str(folder)), str(name), set())).get(key, default)


def _lua_assignments(folder: Path, name: str, seen: set[str]) -> Iterator[tuple[str, Value]]:
    """Yield the assignments of a file and of what it includes, each file once."""
    file = folder / name
    if name in seen or len(seen) == _MAX_LUA_FILES or not file.is_file():
        return
    seen.add(name)
    try:
        text = read_bounded(file, MAX_BYTES).decode("utf-8", "replace")
    except InputError:
        return
    for found in _LUA_LINE.finditer(_LUA_COMMENT.sub("", text)):
        if found["name"]:
            yield found["name"].rpartition(".")[2], _lua_value(found["name"], found["value"])
        else:
            yield from _lua_assignments(folder, found["file"], seen)


def _lua_value(name: str, text: str) -> Value:
    if text[:1] in {"'", '"'}:
        return text[1:-1]
    if text in _LUA_LITERALS:
        return _LUA_LITERALS[text]
    if not _LUA_NUMBER.fullmatch(text):
        return placeholder(name)
    return int(text) if text.isdecimal() else float(text)


def tree_nodes(path: Value, usual_file: str, usual: list[Value]) -> list[Value]:
    """Return the nodes of a file's main tree, each with its ports and its `id`.

    Without a file, and for one called `usual_file` that is not here, they are the usual ones. A
    tree that cannot be read is one node whose `id` is the file's name.
    """
    file = Path(str(path or usual_file))
    if has_placeholder(path):
        return [{"id": str(path)}]
    if file.name == usual_file and not file.is_file():
        return usual
    try:
        text = read_bounded(file, MAX_BYTES).decode("utf-8", "replace")
        found = list(read_tree_nodes(text, str(file)))
    except InputError:
        return [{"id": file.name}]
    return [{**dict(one.ports), "id": one.id} for one in found if one.id not in BUILT_IN_NODES]
