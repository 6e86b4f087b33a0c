"""The commands that set variables: set, unset, list, string, option and the like."""

import os.path
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path, PurePath
from typing import TypeAlias

from rtron.sources.workspace.cmake.command_call import CommandCall
from rtron.sources.workspace.cmake.list_operations import LIST_CHANGES, LIST_RESULTS
from rtron.sources.workspace.cmake.patterns import replace_plain
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
        _apply_pattern(call, words, known=known)
    elif operation == "PREPEND" and len(words) > 1:
        old = call.scope.variables.get(words[1], _NO_VALUE)
        call.set(words[1], "".join(words[2:]) + old.text, known=known and old.known)
    elif operation == "JOIN" and len(words) > 2:  # noqa: PLR2004
        _check_length(len(words) * len(words[1]))
        call.set(words[2], words[1].join(words[3:]), known=known)
    elif operation in _STRING_RESULTS and len(words) > _STRING_RESULTS[operation]:
        call.set(words[_STRING_RESULTS[operation]], "", known=False)


def _apply_pattern(call: CommandCall, words: list[str], *, known: bool) -> None:
    """Carry out `string(REGEX …)`: a replacement of a plain pattern; what else it gives is not."""
    is_replacement = words[1].upper() == "REPLACE"
    text = replace_plain("".join(words[5:]), words[2], words[3]) if is_replacement else None
    call.set(words[4 if is_replacement else 3], text or "", known=known and text is not None)


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
        parts = {"FILENAME": path.name, "STEM": stem, "PARENT_PATH": str(path.parent)}
        part = parts.get(words[2])
        call.set(words[3], part or "", known=value.known and part is not None)


def get_filename_component(call: CommandCall) -> None:
    """Carry out `get_filename_component`."""
    words = call.words
    if len(words) < 3:  # noqa: PLR2004 - variable, file, part
        return
    path = Path(words[1])
    parts = {
        "NAME": path.name,
        "NAME_WE": path.name.split(".")[0],
        "NAME_WLE": path.stem,
        "LAST_EXT": path.suffix,
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
    if words[:1] in (["READ"], ["STRINGS"]) and words[2:]:
        call.set(words[2], "", known=False)
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
    _check_length(text.count(old) * len(new) if old else MAX_LENGTH + 1)
    return text.replace(old, new)


def _check_length(length: int) -> None:
    if length > MAX_LENGTH:
        raise BoundsError("a value becomes too long")


_STRING_RESULTS: Mapping[str, int] = {
    **dict.fromkeys(("TIMESTAMP", "UUID", "JSON"), 1),
    **dict.fromkeys(("LENGTH", "MAKE_C_IDENTIFIER", "CONFIGURE", "GENEX_STRIP"), 2),
    **dict.fromkeys(("FIND", "REPEAT"), 3),
    "SUBSTRING": 4,
}
"""Where operations that are not carried out have the variable of their result."""
_CASE_OPERATIONS: Mapping[str, Callable[[str], str]] = {
    "TOLOWER": str.lower,
    "TOUPPER": str.upper,
    "STRIP": str.strip,
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
