"""The commands that set variables: set, unset, list, string, option and the like."""

import os.path
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path, PurePath
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import (
    MAX_LENGTH,
    BoundsError,
    CommandCall,
    VariableValue,
    split_list,
)
from rtron.sources.workspace.cmake.condition import constant_truth

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
    """Carry out the operations of `list` that decide which sources a program has."""
    words = call.words
    if len(words) < 2:  # noqa: PLR2004 - operation and list
        return
    operation, name, rest = words[0].upper(), words[1], words[2:]
    if operation in _LIST_CHANGES:
        before = call.scope.variables.get(name, _NO_VALUE)
        known = before.known and all(item.known for item in call.items)
        changed = _LIST_CHANGES[operation](split_list(before.text), rest)
        call.set(name, ";".join(changed), known=known)
    else:
        _mark_unknown(call, rest[-1:] if operation in _LIST_READS else words[1:])


def change_string(call: CommandCall) -> None:
    """Carry out the operations of `string` that make names and lists."""
    words = [item.text for item in call.items]
    known, operation = all(item.known for item in call.items), words[:1]
    if operation in (["APPEND"], ["PREPEND"]) and len(words) > 1:
        old, added = call.scope.variables.get(words[1], _NO_VALUE), "".join(words[2:])
        text = old.text + added if operation == ["APPEND"] else added + old.text
        call.set(words[1], text, known=known and old.known)
        return
    index, make = _STRING_RESULTS.get("".join(operation), (0, None))
    if make and index < len(words):
        call.set(words[index], make(words), known=known)
    else:
        set_unknown(call)


def _replace(words: Sequence[str]) -> str:
    """`string(REPLACE old new result text…)`."""
    _, old, new, _, *texts = words
    text = "".join(texts)
    if text.count(old) * len(new) > MAX_LENGTH:
        raise BoundsError("a value becomes too long")
    return text.replace(old, new) if old else text


def _remove_items(elements: list[str], words: list[str]) -> list[str]:
    removed = set(words)
    return [text for text in elements if text not in removed]


_LIST_CHANGES: Mapping[str, Callable[[list[str], list[str]], list[str]]] = {
    "APPEND": lambda elements, words: [*elements, *words],
    "PREPEND": lambda elements, words: [*words, *elements],
    "REMOVE_ITEM": _remove_items,
    "REMOVE_DUPLICATES": lambda elements, _: list(dict.fromkeys(elements)),
    "REVERSE": lambda elements, _: elements[::-1],
    "SORT": lambda elements, _: sorted(elements),
}
_LIST_READS = frozenset({"LENGTH", "GET", "JOIN", "SUBLIST", "FIND"})
_STRING_RESULTS: Mapping[str, tuple[int, Callable[[Sequence[str]], str]]] = {
    "TOLOWER": (2, lambda words: words[1].lower()),
    "TOUPPER": (2, lambda words: words[1].upper()),
    "STRIP": (2, lambda words: words[1].strip()),
    "CONCAT": (1, lambda words: "".join(words[2:])),
    "REPLACE": (3, _replace),
}
"""Where an operation's result goes, and what it is."""


def set_unknown(call: CommandCall) -> None:
    """Carry out what only a build finds out, or what decides no program: results are unknown.

    Which of its words is a result is not looked at: what is not set is unknown anyway.
    """
    _mark_unknown(call, call.words)


def _mark_unknown(call: CommandCall, names: Iterable[str]) -> None:
    variables = call.scope.variables
    for name in names:
        if name in variables:
            call.set(name, variables[name].text, known=False)


def get_filename_component(call: CommandCall) -> None:
    """Carry out `get_filename_component`."""
    words = [item.text for item in call.items]
    if len(words) < 3:  # noqa: PLR2004 - variable, file, part
        return
    path = Path(words[1])
    parts = {
        "NAME": path.name,
        "NAME_WE": path.name.split(".")[0],
        "NAME_WLE": path.stem,
        "LAST_EXT": path.suffix,
        "EXT": path.name[len(path.name.split(".")[0]) :],
        "PATH": _folder(path),
        "DIRECTORY": _folder(path),
        "ABSOLUTE": os.path.normpath(call.scope.folder / path),
        "REALPATH": os.path.normpath(call.scope.folder / path),
    }
    known = words[2] in parts and all(item.known for item in call.items)
    call.set(words[0], parts.get(words[2], ""), known=known)


def _folder(path: PurePath) -> str:
    """Return the folder of a path; a name alone has none."""
    return "" if path.parent == PurePath() else str(path.parent)


def glob_files(call: CommandCall) -> None:
    """Carry out `file GLOB` and `file GLOB_RECURSE`, inside the package."""
    words = call.words
    if words[:1] in (["READ"], ["STRINGS"]):
        set_unknown(call)
    if len(words) < 2 or words[0].upper() not in {"GLOB", "GLOB_RECURSE"}:  # noqa: PLR2004
        return
    recursive, patterns = words[0].upper() == "GLOB_RECURSE", words[2:]
    start = _take_option(patterns, "RELATIVE")
    listing = _take_option(patterns, "LIST_DIRECTORIES")
    with_folders = constant_truth(listing) is True if listing else not recursive
    found: dict[str, None] = {}
    for pattern in patterns:
        call.budget.spend(64 * len(call.build.files.names))
        path = str(call.scope.folder / pattern)
        paths = call.build.files.glob(path, recursive=recursive, with_folders=with_folders)
        found.update((os.path.relpath(path, start) if start else str(path), None) for path in paths)
    call.set(words[1], ";".join(found))


def _take_option(words: list[str], name: str) -> str:
    """Take an option with its value out of words; return the value, empty without the option."""
    if name not in words[:-1]:
        return ""
    index = words.index(name)
    _, value = words.pop(index), words.pop(index)
    return value


def source_directory(call: CommandCall) -> None:
    """Carry out `aux_source_directory`: all sources right in a folder."""
    words = call.words
    if len(words) == 2:  # noqa: PLR2004 - folder and variable
        pattern = str(call.scope.folder / words[0] / "*.c*")
        old = split_list(call.scope.variables.get(words[1], _NO_VALUE).text)
        found = call.build.files.glob(pattern, recursive=False, with_folders=False)
        call.set(words[1], ";".join((*old, *map(str, found))))


def set_empty(call: CommandCall) -> None:
    """Set the variable of a command that generates code from headers or forms: none to read."""
    for name in call.words[:1]:
        call.set(name, "")


VARIABLE_COMMANDS: Mapping[str, Handler] = {
    "set": set_variable,
    "unset": unset,
    "option": define_option,
    "list": change_list,
    "string": change_string,
    "get_filename_component": get_filename_component,
    "file": glob_files,
    "aux_source_directory": source_directory,
    **dict.fromkeys(("cmake_parse_arguments", "cmake_path", "execute_process"), set_unknown),
    **dict.fromkeys(("find_program", "find_path", "find_file", "find_library"), set_unknown),
    "math": set_unknown,
    **dict.fromkeys(
        (f"qt{version}_{command}" for version in "45" for command in ("wrap_cpp", "wrap_ui")),
        set_empty,
    ),
    "qt4_add_resources": set_empty,
    "qt5_add_resources": set_empty,
}
