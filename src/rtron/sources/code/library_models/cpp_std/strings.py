"""Strings and streams of C++, on text that may be known in part."""

from collections.abc import Callable
from typing import Any

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    LibraryClass,
    ListValue,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    is_text,
    map_options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments


def make_string(_: AbstractMachine, arguments: Arguments) -> Value:
    """Make a string: of a text, of an array's letters, or of a letter so many times."""
    given, letter = arguments.get(0), arguments.get(1)
    if isinstance(given, ListValue):
        return Unknown("text")
    if isinstance(given, Scalar) and isinstance(given.value, int) and isinstance(letter, Scalar):
        return Scalar(str(letter.value) * max(0, min(given.value, 256)))
    return Scalar("") if given is None else given


def make_number_value(name: str, _: AbstractMachine, arguments: Arguments) -> Value:
    """Make a number; one that is not initialised may be anything."""
    given = arguments.get(0)
    return Unknown(name) if given is None else given


def to_string(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """Return `std::to_string(number)`."""

    def shown(value: Value) -> Value:
        if isinstance(value, Scalar) and isinstance(value.value, float):
            return Scalar(f"{value.value:f}", value.tainted)
        if isinstance(value, Scalar) and isinstance(value.value, bool):
            return Scalar(str(int(value.value)), value.tainted)
        return concat((value,))

    return map_options(arguments.get(0) or Scalar(""), shown)


def change_case(
    change: Callable[[str], str], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    """Return a letter, or a text, in upper or lower case."""

    def changed(value: Value) -> Value:
        if isinstance(value, Scalar) and isinstance(value.value, str):
            return Scalar(change(value.value), value.tainted)
        return Unknown("text")

    return map_options(arguments.value(0), changed)


def lexical_cast(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """Return `boost::lexical_cast<T>(value)`."""
    target = str(arguments.types[0]) if arguments.types else "std::string"
    if "string" in target:
        return concat((arguments.get(0) or Scalar(""),))
    return parse_number(float if target in {"double", "float"} else int, machine, None, arguments)


def choose_number(
    choose: Callable[[Any], object], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    """Return the largest or the least of some numbers, `std::max(a, b)`."""
    given = arguments.get(0)
    values = items_of(given)[0] if isinstance(given, ListValue) else arguments.values[:2]
    numbers = [value.value for value in values if isinstance(value, Scalar)]
    known = len(numbers) == len(values) and all(isinstance(one, (int, float)) for one in numbers)
    tainted = any(map(is_tainted, values))
    return Scalar(choose(numbers), tainted) if numbers and known else Unknown("number", tainted)


def parse_number(
    make: Callable[[Any], object], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    """Return a number that is read from a text."""
    value = arguments.get(0)
    if not isinstance(value, Scalar):
        return Unknown("number", value is not None and is_tainted(value))
    try:
        return Scalar(make(value.value), value.tainted)
    except (TypeError, ValueError):
        return Unknown("number")


def _stream(_: AbstractMachine, arguments: Arguments) -> Value:
    return Instance(STREAM, {"text": arguments.get(0) or Scalar("")})


def _write(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    before, added = owner.fields["text"], arguments.get(0) or Scalar("")
    whole = added if before == Scalar("") and is_text(added) else concat((before, added))
    machine.undo_log.set(owner.fields, "text", whole)
    return owner


def read_text(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """Return `stream.str()`, after `stream.str(text)` the new text."""
    if arguments.values:
        machine.undo_log.set(owner.fields, "text", arguments.values[0])
    return owner.fields["text"]


def stream_text(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`boost::str(format)`."""
    given = arguments.get(0) or Scalar("")
    return given.fields.get("text", given) if isinstance(given, Instance) else given


def getline(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`getline(stream, line, separator)`: the text up to a separator, while there is any."""
    stream, slot = arguments.get(0), arguments.slot(1)
    separator = arguments.get(2) or Scalar("\n")
    if not isinstance(stream, Instance) or stream.type is not STREAM or slot is None:
        return _set_unknown_line(machine, arguments)
    text = stream.fields["text"]
    if not (isinstance(text, Scalar) and isinstance(separator, Scalar)):
        return _set_unknown_line(machine, arguments)
    line, _, rest = str(text.value).partition(str(separator.value))
    if not text.value:
        return Scalar(value=False)
    machine.undo_log.set(*slot, Scalar(line, text.tainted))
    machine.undo_log.set(stream.fields, "text", Scalar(rest, text.tainted))
    return Scalar(value=True)


def _set_unknown_line(machine: AbstractMachine, arguments: Arguments) -> Value:
    slot = arguments.slot(1)
    if slot is not None:
        machine.undo_log.set(*slot, Unknown("line"))
    return Unknown("getline")


def _extract(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`stream >> word` of a known text."""
    text, slot = owner.fields["text"], arguments.slot(0)
    if not isinstance(text, Scalar) or slot is None:
        return Unknown("stream")
    word, _, rest = str(text.value).lstrip().partition(" ")
    if word:
        machine.undo_log.set(*slot, Scalar(word, text.tainted))
    machine.undo_log.set(owner.fields, "text", Scalar(rest, text.tainted))
    machine.undo_log.set(owner.fields, "truth", Scalar(bool(word)))
    return owner


def copy_string(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`strcpy(target, source)`."""
    slot = arguments.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, arguments.get(1) or Unknown("strcpy"))
    return arguments.get(1) or Unknown("strcpy")


def compare_strings(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """Return `strcmp(left, right)`: 0 where they are alike."""
    left, right = arguments.get(0), arguments.get(1)
    if isinstance(left, Scalar) and isinstance(right, Scalar):
        a, b = str(left.value), str(right.value)
        return Scalar((a > b) - (a < b), left.tainted)
    return Unknown("strcmp")


STREAM = LibraryClass(
    "std::stringstream",
    _stream,
    {"operator<<": _write, "operator>>": _extract, "str": read_text, "toStdString": read_text},
)
