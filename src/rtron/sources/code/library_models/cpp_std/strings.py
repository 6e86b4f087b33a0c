"""Strings, streams and formats of C++, on text that may have holes."""

from collections.abc import Callable
from typing import Any

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.operators import percent
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Instance,
    Known,
    ListValue,
    NativeClass,
    Value,
    concat,
    each,
    is_tainted,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments


def make_text(_: Machine, arguments: Arguments) -> Value:
    """Make a string: of a text, or of a letter so many times."""
    given, letter = arguments.get(0), arguments.get(1)
    if isinstance(given, Known) and isinstance(given.value, int) and isinstance(letter, Known):
        return Known(str(letter.value) * max(0, min(given.value, 256)))
    return Known("") if given is None else given


def make_number(name: str, _: Machine, arguments: Arguments) -> Value:
    """Make a number; one that is not initialised may be anything."""
    given = arguments.get(0)
    return Hole(name) if given is None else given


def to_string(_: Machine, __: object, arguments: Arguments) -> Value:
    """Return `std::to_string(number)`."""

    def shown(value: Value) -> Value:
        if isinstance(value, Known) and isinstance(value.value, float):
            return Known(f"{value.value:f}", value.tainted)
        if isinstance(value, Known) and isinstance(value.value, bool):
            return Known(str(int(value.value)), value.tainted)
        return concat((value,))

    return each(arguments.get(0) or Known(""), shown)


def lexical_cast(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Return `boost::lexical_cast<T>(value)`."""
    target = str(arguments.types[0]) if arguments.types else "std::string"
    if "string" in target:
        return concat((arguments.get(0) or Known(""),))
    return parsed(float if target in {"double", "float"} else int, machine, None, arguments)


def parsed(make: Callable[[Any], object], _: Machine, __: object, arguments: Arguments) -> Value:
    """Return a number that is read from a text."""
    value = arguments.get(0)
    if not isinstance(value, Known):
        return Hole("number", value is not None and is_tainted(value))
    try:
        return Known(make(value.value), value.tainted)
    except (TypeError, ValueError):
        return Hole("number")


def _stream(_: Machine, arguments: Arguments) -> Value:
    return Instance(STREAM, {"text": arguments.get(0) or Known("")})


def _write(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    added = concat((owner.fields["text"], arguments.get(0) or Known("")))
    machine.trail.set(owner.fields, "text", added)
    return owner


def _read(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    if arguments.values:
        machine.trail.set(owner.fields, "text", arguments.values[0])
    return owner.fields["text"]


def text_of(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::str(format)`."""
    given = arguments.get(0) or Known("")
    return given.fields.get("text", given) if isinstance(given, Instance) else given


def getline(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`getline(stream, line, separator)`: the text up to a separator, while there is any."""
    stream, place = arguments.get(0), arguments.place(1)
    separator = arguments.get(2) or Known("\n")
    if not isinstance(stream, Instance) or stream.type is not STREAM or place is None:
        return _forget(machine, arguments)
    text = stream.fields["text"]
    if not (isinstance(text, Known) and isinstance(separator, Known)):
        return _forget(machine, arguments)
    line, _, rest = str(text.value).partition(str(separator.value))
    if not text.value:
        return Known(value=False)
    machine.trail.set(*place, Known(line, text.tainted))
    machine.trail.set(stream.fields, "text", Known(rest, text.tainted))
    return Known(value=True)


def _forget(machine: Machine, arguments: Arguments) -> Value:
    place = arguments.place(1)
    if place is not None:
        machine.trail.set(*place, Hole("line"))
    return Hole("getline")


def _extract(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`stream >> word` of a known text."""
    text, place = owner.fields["text"], arguments.place(0)
    if not isinstance(text, Known) or place is None:
        return Hole("stream")
    word, _, rest = str(text.value).lstrip().partition(" ")
    if word:
        machine.trail.set(*place, Known(word, text.tainted))
    machine.trail.set(owner.fields, "text", Known(rest, text.tainted))
    machine.trail.set(owner.fields, "truth", Known(bool(word)))
    return owner


def _boost_format(_: Machine, arguments: Arguments) -> Value:
    return Instance(FORMAT, {"text": arguments.get(0) or Known("")})


def _fill(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`boost::format("%s_%d") % a % b`: each % fills the next place."""
    template = owner.fields["text"]
    if not isinstance(template, Known):
        return owner
    before, mark, after = str(template.value).partition("%")
    number = after[:1].isdigit() and after[1:2] == "%"
    spec, rest = ("s", after[2:]) if number else (after[:1], after[1:])
    filled = percent(Known(f"{before}{mark}{spec}"), listed((arguments.get(0) or NONE,), "tuple"))
    return Instance(FORMAT, {"text": concat((filled, Known(rest)))})


def sprintf(offset: int, machine: Machine, _: object, arguments: Arguments) -> Value:
    """`sprintf(buffer, format, …)`, `snprintf(buffer, size, format, …)`."""
    place, format = arguments.place(0), arguments.get(offset)
    if place is None or format is None:
        return Hole("sprintf")
    text = percent(format, listed(arguments.values[offset + 1 :], "tuple"))
    machine.trail.set(*place, text)
    return Hole("sprintf")


def copy_text(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`strcpy(target, source)`."""
    place = arguments.place(0)
    if place is not None:
        machine.trail.set(*place, arguments.get(1) or Hole("strcpy"))
    return arguments.get(1) or Hole("strcpy")


def joined(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::algorithm::join(words, separator)`."""
    items, certain = items_of(arguments.get(0) or NONE)
    separator = arguments.get(1) or Known("")
    spread = [part for item in items for part in (separator, item)]
    return concat(spread[1:]) if certain else Hole("join")


def split(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`boost::split(words, text, boost::is_any_of(" "))` (boost: string algorithms)."""
    words, text, separators = arguments.get(0), arguments.get(1), arguments.get(2)
    if not isinstance(words, ListValue):
        return NONE
    if not (isinstance(text, Known) and isinstance(separators, Known)):
        machine.trail.open(words.fields)
        return words
    pieces = str(text.value)
    for letter in str(separators.value)[1:]:
        pieces = pieces.replace(letter, str(separators.value)[0])
    found = pieces.split(str(separators.value)[:1] or None)
    machine.trail.set(words.fields, "items", tuple(Known(piece, text.tainted) for piece in found))
    return words


def compare_texts(_: Machine, __: object, arguments: Arguments) -> Value:
    """Return `strcmp(left, right)`: 0 where they are alike."""
    left, right = arguments.get(0), arguments.get(1)
    if isinstance(left, Known) and isinstance(right, Known):
        a, b = str(left.value), str(right.value)
        return Known((a > b) - (a < b), left.tainted)
    return Hole("strcmp")


STREAM = NativeClass(
    "std::stringstream",
    _stream,
    {"operator<<": _write, "operator>>": _extract, "str": _read, "toStdString": _read},
)


FORMAT = NativeClass(
    "boost::format", _boost_format, {"operator%": _fill, "str": _read, "toStdString": _read}
)
