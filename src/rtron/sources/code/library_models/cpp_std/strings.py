"""Strings, streams and formats of C++, on text that may be known in part."""

from collections.abc import Callable
from typing import Any

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.operators import percent_format
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    ListValue,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    map_options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments


def make_string(_: AbstractMachine, arguments: Arguments) -> Value:
    """Make a string: of a text, or of a letter so many times."""
    given, letter = arguments.get(0), arguments.get(1)
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
    added = concat((owner.fields["text"], arguments.get(0) or Scalar("")))
    machine.undo_log.set(owner.fields, "text", added)
    return owner


def _read(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
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


def _boost_format(_: AbstractMachine, arguments: Arguments) -> Value:
    return Instance(FORMAT, {"text": arguments.get(0) or Scalar("")})


def _fill_placeholder(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`boost::format("%s_%d") % a % b`: each % fills the next placeholder."""
    template = owner.fields["text"]
    if not isinstance(template, Scalar):
        return owner
    before, mark, after = str(template.value).partition("%")
    number = after[:1].isdigit() and after[1:2] == "%"
    spec, rest = ("s", after[2:]) if number else (after[:1], after[1:])
    filled = percent_format(
        Scalar(f"{before}{mark}{spec}"), list_of((arguments.get(0) or NONE,), "tuple")
    )
    return Instance(FORMAT, {"text": concat((filled, Scalar(rest)))})


def sprintf(offset: int, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`sprintf(buffer, format, …)`, `snprintf(buffer, size, format, …)`."""
    slot, format = arguments.slot(0), arguments.get(offset)
    if slot is None or format is None:
        return Unknown("sprintf")
    text = percent_format(format, list_of(arguments.values[offset + 1 :], "tuple"))
    machine.undo_log.set(*slot, text)
    return Unknown("sprintf")


def copy_string(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`strcpy(target, source)`."""
    slot = arguments.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, arguments.get(1) or Unknown("strcpy"))
    return arguments.get(1) or Unknown("strcpy")


def join_strings(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`boost::algorithm::join(words, separator)`."""
    items, certain = items_of(arguments.get(0) or NONE)
    separator = arguments.get(1) or Scalar("")
    spread = [part for item in items for part in (separator, item)]
    return concat(spread[1:]) if certain else Unknown("join")


def split_string(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`boost::split(words, text, boost::is_any_of(" "))` (boost: string algorithms)."""
    words, text, separators = arguments.get(0), arguments.get(1), arguments.get(2)
    if not isinstance(words, ListValue):
        return NONE
    if not (isinstance(text, Scalar) and isinstance(separators, Scalar)):
        machine.undo_log.mark_open(words.fields)
        return words
    pieces = str(text.value)
    for letter in str(separators.value)[1:]:
        pieces = pieces.replace(letter, str(separators.value)[0])
    found = pieces.split(str(separators.value)[:1] or None)
    machine.undo_log.set(
        words.fields, "items", tuple(Scalar(piece, text.tainted) for piece in found)
    )
    return words


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
    {"operator<<": _write, "operator>>": _extract, "str": _read, "toStdString": _read},
)


FORMAT = LibraryClass(
    "boost::format",
    _boost_format,
    {"operator%": _fill_placeholder, "str": _read, "toStdString": _read},
)
