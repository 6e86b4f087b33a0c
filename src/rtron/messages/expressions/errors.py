"""What is wrong with an expression, in the user's words instead of the compiler's."""

import re
from collections.abc import Collection, Mapping

from rtron.errors import InputError, suggestion
from rtron.messages.common.definition import Definition

_ERROR = re.compile(r"ERROR: <input>:(-?\d+):(-?\d+): ([^\n]*)")
_FIELD = re.compile(r"undefined field '(.*)' not found in struct '(.*)'")
_NAME = re.compile(r"undeclared reference to '([^'.]*).*'")
_OVERLOAD = re.compile(r"found no matching overload for '(.*)' applied to '\((.*)\)'")
_STATUS = re.compile(r"^[A-Z_]+: | \[[A-Z_]+\]$")
_OPERATOR = re.compile(r"_(.+)_|(.+)_")
_TAKES = {
    "inside": "inside takes a Point and an area",
    "distance": "distance takes a Point, and a Point or the name of an area",
    "place": "place takes two numbers with decimal points, for example place(3.0, 4.0)",
}
_MAX_MESSAGE = 300


class CheckError(Exception):
    """A fault in an expression, in the words and with the place of Google's compiler."""


def expression_error(
    compiler_message: str, text: str, types: Mapping[str, Definition], names: Collection[str]
) -> InputError:
    """Return the error for what CEL's compiler said about `text`: the first of its faults."""
    found = _ERROR.search(compiler_message)
    if not found or int(found[1]) < 1:
        plain = found[3] if found else _STATUS.sub("", compiler_message)
        return InputError(f"in the expression: {plain[:_MAX_MESSAGE]}", help="make it simpler")
    what, help = _explain(found[3].replace(" (in container '')", ""), types, names)
    line = f"line {found[1]}, " if "\n" in text.strip() else ""
    return InputError(
        f"{line}column {found[2]} of the expression: {what[:_MAX_MESSAGE]}", help=help
    )


def _explain(
    compiler_message: str, types: Mapping[str, Definition], names: Collection[str]
) -> tuple[str, str]:
    if field := _FIELD.fullmatch(compiler_message):
        return _unknown_field(field[1], types.get(field[2].replace(".", "/")), field[2])
    if name := _NAME.fullmatch(compiler_message):
        return f"nothing is called {name[1]!r}", suggestion(name[1], sorted(names))
    if overload := _OVERLOAD.fullmatch(compiler_message):
        return _mismatch(overload[1], overload[2])
    return compiler_message, "see cel.dev for the language"


def _unknown_field(name: str, owner: Definition | None, type: str) -> tuple[str, str]:
    fields = [field.name for field in owner.fields] if owner else []
    return f"{type.replace('.', '/')} has no field {name!r}", suggestion(name, sorted(fields))


def _mismatch(function: str, types: str) -> tuple[str, str]:
    operator = _OPERATOR.fullmatch(function)
    name = (operator[1] or operator[2]) if operator else function
    what = f"{name} cannot be applied to ({types})"
    if function in _TAKES:
        return what, _TAKES[function]
    if set(types.split(", ")) == {"double", "int"}:
        return what, "write numbers compared with a float with a point: 1.0 instead of 1"
    return what, "both sides must have the same type"
