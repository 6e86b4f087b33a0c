"""The commands that set variables: set, unset, list, string, option and the like."""

import os.path
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import CommandCall
from rtron.sources.workspace.cmake.values import MAX_LENGTH, BoundsError, VariableValue, split_list

Handler: TypeAlias = Callable[[CommandCall], None]

_NO_VALUE = VariableValue("")


def set_variable(call: CommandCall) -> None:
    """Carry out `set`: in the parent's scope for PARENT_SCOPE, as a default for CACHE."""
    if not call.words or call.items[0].text.startswith("ENV{"):
        return
    name, values = call.items[0].text, list(call.items[1:])
    words = [item.text for item in values]
    if words[-1:] == ["PARENT_SCOPE"]:
        values.pop()
    elif "CACHE" in words:
        values = values[: words.index("CACHE")]
        if name in call.scope.variables:
            return
    text = ";".join(item.text for item in values)
    call.budget.spend(len(text))
    value = VariableValue(text, all(item.known for item in values))
    scope = call.scope.parent if words[-1:] == ["PARENT_SCOPE"] else call.scope
    if scope is None:
        return
    scope.set(name, value)


def unset(call: CommandCall) -> None:
    """Unset a variable: what is not set reads as empty."""
    for name in call.words[:1]:
        call.set(name, "")


def define_option(call: CommandCall) -> None:
    """Give an option default, off if it has none."""
    words = call.words
    if words and words[0] not in call.scope.variables:
        call.set(words[0], words[2] if len(words) > 2 else "OFF")  # noqa: PLR2004 - name, text, value


def change_list(call: CommandCall) -> None:
    """Carry out `list`; what it reports about a list is unknown, but for LENGTH."""
    words = call.words
    if len(words) < 2:  # noqa: PLR2004 - operation and list
        return
    operation, name, rest = words[0].upper(), words[1], words[2:]
    before = call.scope.variables.get(name, _NO_VALUE)
    known = before.known and all(item.known for item in call.items)
    if operation in _LIST_OPERATIONS:
        changed = _LIST_OPERATIONS[operation](split_list(before.text), rest)
        call.set(name, ";".join(changed), known=known)
    elif operation == "LENGTH" and rest:
        call.set(rest[0], str(len(split_list(before.text))), known=known)
    elif operation in {"GET", "FIND", "JOIN", "SUBLIST"} and rest:
        call.set(rest[-1], "", known=False)


def change_string(call: CommandCall) -> None:
    """Carry out `string`, as far as it works on plain text."""
    words = [item.text for item in call.items]
    known = all(item.known for item in call.items)
    operation = words[0].upper() if words else ""
    if operation in {"TOLOWER", "TOUPPER", "STRIP"} and len(words) == 3:  # noqa: PLR2004
        call.set(words[2], _CASE_OPERATIONS[operation](words[1]), known=known)
    elif operation == "REPLACE" and len(words) > 4:  # noqa: PLR2004
        call.set(words[3], _replace_text("".join(words[4:]), words[1], words[2]), known=known)
    elif operation in {"CONCAT", "APPEND"} and len(words) > 1:
        old = call.scope.variables.get(words[1], _NO_VALUE) if operation == "APPEND" else _NO_VALUE
        call.set(words[1], old.text + "".join(words[2:]), known=known and old.known)
    elif operation == "REGEX" and len(words) > 4:  # noqa: PLR2004
        call.set(words[4 if words[1].upper() == "REPLACE" else 3], "", known=False)


def get_filename_component(call: CommandCall) -> None:
    """Carry out `get_filename_component`."""
    words = call.words
    if len(words) < 3:  # noqa: PLR2004 - variable, file, part
        return
    path = Path(words[1])
    parts = {
        "NAME": path.name,
        "NAME_WE": path.name.split(".")[0],
        "EXT": path.name[len(path.name.split(".")[0]) :],
        "PATH": str(path.parent),
        "DIRECTORY": str(path.parent),
        "ABSOLUTE": os.path.normpath(call.scope.folder / path),
        "REALPATH": os.path.normpath(call.scope.folder / path),
    }
    known = words[2] in parts and all(item.known for item in call.items)
    call.set(words[0], parts.get(words[2], ""), known=known)


def glob_files(call: CommandCall) -> None:
    """Carry out `file GLOB` and `file GLOB_RECURSE`, inside the package."""
    words = call.words
    if len(words) < 2 or words[0].upper() not in {"GLOB", "GLOB_RECURSE"}:  # noqa: PLR2004
        return
    recursive, patterns, start = words[0].upper() == "GLOB_RECURSE", words[2:], None
    if "RELATIVE" in patterns[:-1]:
        index = patterns.index("RELATIVE")
        start = patterns[index + 1]
        del patterns[index : index + 2]
    found: dict[str, None] = {}
    for pattern in patterns:
        call.budget.spend(64 * len(call.build.files.names))
        paths = call.build.files.glob(str(call.scope.folder / pattern), recursive=recursive)
        found.update((os.path.relpath(path, start) if start else str(path), None) for path in paths)
    call.set(words[1], ";".join(found))


def source_directory(call: CommandCall) -> None:
    """Carry out `aux_source_directory`: all sources right in a folder."""
    words = call.words
    if len(words) == 2:  # noqa: PLR2004 - folder and variable
        pattern = str(call.scope.folder / words[0] / "*.c*")
        old = split_list(call.scope.variables.get(words[1], _NO_VALUE).text)
        found = call.build.files.glob(pattern, recursive=False)
        call.set(words[1], ";".join((*old, *map(str, found))))


def set_empty(call: CommandCall) -> None:
    """Set the variable of a command that generates code from headers or forms: none to read."""
    for name in call.words[:1]:
        call.set(name, "")


def _replace_text(text: str, old: str, new: str) -> str:
    if not old or text.count(old) * len(new) > MAX_LENGTH:
        raise BoundsError("a value becomes too long")
    return text.replace(old, new)


def _remove_items(old: list[str], rest: list[str]) -> list[str]:
    removed = set(rest)
    return [text for text in old if text not in removed]


def _insert(old: list[str], rest: list[str]) -> list[str]:
    return [*old, *rest[1:]]


_CASE_OPERATIONS: Mapping[str, Callable[[str], str]] = {
    "TOLOWER": str.lower,
    "TOUPPER": str.upper,
    "STRIP": str.strip,
}
_LIST_OPERATIONS: Mapping[str, Callable[[list[str], list[str]], list[str]]] = {
    "APPEND": lambda old, rest: [*old, *rest],
    "PREPEND": lambda old, rest: [*rest, *old],
    "INSERT": _insert,
    "REMOVE_ITEM": _remove_items,
    "REMOVE_DUPLICATES": lambda old, _: list(dict.fromkeys(old)),
    "REVERSE": lambda old, _: old[::-1],
    "SORT": lambda old, _: sorted(old),
}
VARIABLE_COMMANDS: Mapping[str, Handler] = {
    "set": set_variable,
    "unset": unset,
    "option": define_option,
    "list": change_list,
    "string": change_string,
    "get_filename_component": get_filename_component,
    "file": glob_files,
    "aux_source_directory": source_directory,
    **dict.fromkeys(
        (f"qt{version}_{command}" for version in "45" for command in ("wrap_cpp", "wrap_ui")),
        set_empty,
    ),
    "qt4_add_resources": set_empty,
    "qt5_add_resources": set_empty,
}
