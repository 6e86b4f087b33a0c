"""The commands that set variables: set, unset, list, string, option and the like."""

import os.path
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path, PurePath
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import CommandCall, VariableValue, split_list
from rtron.sources.workspace.cmake.condition import constant_truth
from rtron.sources.workspace.cmake.list_operations import (
    LIST_CHANGES,
    LIST_RESULTS,
    string_operation,
)

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
    """Carry out `list`; what an operation makes that is not known here is unknown."""
    words = call.words
    if len(words) < 2:  # noqa: PLR2004 - operation and list
        return
    operation, name, rest = words[0].upper(), words[1], words[2:]
    before = call.scope.variables.get(name, _NO_VALUE)
    known = before.known and all(item.known for item in call.items)
    elements = split_list(before.text)
    if operation in LIST_RESULTS and rest:
        result = LIST_RESULTS[operation](elements, rest[:-1])
        call.set(rest[-1], result or "", known=known and result is not None)
    elif operation in {"POP_BACK", "POP_FRONT"}:
        _pop(call, name, rest, known=known)
    elif operation in LIST_CHANGES:
        changed = LIST_CHANGES[operation](elements, rest)
        is_known = known and changed is not None
        call.set(name, ";".join(elements if changed is None else changed), known=is_known)
    else:
        call.set(name, before.text, known=False)


def _pop(call: CommandCall, name: str, results: list[str], *, known: bool) -> None:
    """Carry out `list(POP_FRONT …)`: each variable gets an element, without any one is lost."""
    elements = split_list(call.scope.variables.get(name, _NO_VALUE).text)
    end = 0 if call.words[0].upper() == "POP_FRONT" else -1
    for result in results or [""]:
        taken = elements.pop(end) if elements else ""
        if result:
            call.set(result, taken, known=known)
    call.set(name, ";".join(elements), known=known)


def change_string(call: CommandCall) -> None:
    """Carry out `string`; what an operation makes that is not known here is unknown."""
    words = [item.text for item in call.items]
    known, operation = all(item.known for item in call.items), words[:1]
    if operation in (["APPEND"], ["PREPEND"]) and len(words) > 1:
        old, added = call.scope.variables.get(words[1], _NO_VALUE), "".join(words[2:])
        text = old.text + added if operation == ["APPEND"] else added + old.text
        call.set(words[1], text, known=known and old.known)
        return
    index, make = string_operation(words) or (len(words), None)
    if make is not None and index < len(words):
        made = make(words)
        call.set(words[index], made or "", known=known and made is not None)


def set_unknown(call: CommandCall) -> None:
    """Set what a command finds out in a build: its variable is the first argument."""
    for name in call.words[:1]:
        call.set(name, "", known=False)


def run_process(call: CommandCall) -> None:
    """Set the variables of `execute_process`: what a process says is not known."""
    for word, name in pairwise(call.words):
        if word in {"OUTPUT_VARIABLE", "RESULT_VARIABLE", "ERROR_VARIABLE"}:
            call.set(name, "", known=False)


def evaluate_expression(call: CommandCall) -> None:
    """Set the variable of `math(EXPR …)`, whose value is not worked out."""
    for name in call.words[1:2]:
        call.set(name, "", known=False)


def get_path_part(call: CommandCall) -> None:
    """Carry out `cmake_path(GET path part [LAST_ONLY] result)`."""
    words = [word for word in call.words if word != "LAST_ONLY"]
    if len(words) == 4 and words[0] == "GET":  # noqa: PLR2004 - GET, variable, part, result
        value = call.scope.variables.get(words[1], VariableValue("", known=False))
        path, is_last = PurePath(value.text), "LAST_ONLY" in call.words
        stem = path.stem if is_last else path.name.split(".")[0]
        parts = {"FILENAME": path.name, "STEM": stem, "PARENT_PATH": _folder(path)}
        part = parts.get(words[2])
        call.set(words[3], part or "", known=value.known and part is not None)


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
    if words[:1] in (["READ"], ["STRINGS"]) and words[2:]:
        call.set(words[2], "", known=False)
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
    "cmake_path": get_path_part,
    "execute_process": run_process,
    "math": evaluate_expression,
    **dict.fromkeys(("find_program", "find_path", "find_file", "find_library"), set_unknown),
    **dict.fromkeys(
        (f"qt{version}_{command}" for version in "45" for command in ("wrap_cpp", "wrap_ui")),
        set_empty,
    ),
    "qt4_add_resources": set_empty,
    "qt5_add_resources": set_empty,
}
