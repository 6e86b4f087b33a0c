"""Strings, streams, formats and files of C++, on text that may be known in part."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall
from rtron.sources.code.library_models.common.strings import compare, fill_fields
from rtron.sources.code.library_models.common.trivial_functions import returning_field


def make_string(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a string: of a text, of an array's letters, or of a letter so many times."""
    given, letter = arguments.get(0), arguments.get(1)
    if isinstance(given, av.ListValue):
        return av.Unknown("text")
    count = given.value if isinstance(given, av.Scalar) else None
    if isinstance(count, int) and isinstance(letter, av.Scalar):
        return av.Scalar(str(letter.value) * max(0, min(count, 256)))
    return av.Scalar("") if given is None else given


def make_number_value(name: str, _: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a number; one that is not initialised may be anything."""
    given = arguments.get(0)
    return av.Unknown(name) if given is None else given


def to_string(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """Return `std::to_string(number)`."""

    def shown(value: av.Value) -> av.Value:
        if isinstance(value, av.Scalar) and isinstance(value.value, float):
            return av.Scalar(f"{value.value:f}", value.tainted)
        if isinstance(value, av.Scalar) and isinstance(value.value, bool):
            return av.Scalar(str(int(value.value)), value.tainted)
        return av.concat((value,))

    return av.map_options(arguments.get(0) or av.Scalar(""), shown)


def lexical_cast(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Return `boost::lexical_cast<T>(value)`."""
    target = str(arguments.types[0]) if arguments.types else "std::string"
    if "string" in target:
        return av.concat((arguments.get(0) or av.Scalar(""),))
    return parse_number(float if target in {"double", "float"} else int, machine, None, arguments)


def choose_number(
    choose: Callable[[Any], object], _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """Return the largest or the least of some numbers, `std::max(a, b)`."""
    given = arguments.get(0)
    values = av.items_of(given)[0] if isinstance(given, av.ListValue) else arguments.values[:2]
    numbers = [value.value for value in values if isinstance(value, av.Scalar)]
    known = len(numbers) == len(values) and all(isinstance(one, (int, float)) for one in numbers)
    tainted = any(map(av.is_tainted, values))
    is_known = bool(numbers) and known
    return av.Scalar(choose(numbers), tainted) if is_known else av.Unknown("number", tainted)


def parse_number(
    make: Callable[[Any], object], _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """Return a number that is read from a text."""
    value = arguments.get(0)
    if not isinstance(value, av.Scalar):
        return av.Unknown("number", value is not None and av.is_tainted(value))
    try:
        return av.Scalar(make(value.value), value.tainted)
    except (TypeError, ValueError):
        return av.Unknown("number")


def _stream(_: AbstractMachine, arguments: Arguments) -> av.Value:
    return av.Instance(STREAM, {"text": arguments.get(0) or av.Scalar("")})


def _write(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    before, added = owner.fields["text"], arguments.get(0) or av.Scalar("")
    whole = added if before == av.Scalar("") and av.is_text(added) else av.concat((before, added))
    machine.undo_log.set(owner.fields, "text", whole)
    return owner


def read_text(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """Return `stream.str()`, after `stream.str(text)` the new text."""
    if arguments.values:
        machine.undo_log.set(owner.fields, "text", arguments.values[0])
    return owner.fields["text"]


def stream_text(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`boost::str(format)`."""
    given = arguments.get(0) or av.Scalar("")
    return given.fields.get("text", given) if isinstance(given, av.Instance) else given


def getline(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`getline(stream, line, separator)`: the text up to a separator, while there is any."""
    stream, slot = arguments.get(0), arguments.slot(1)
    separator = arguments.get(2) or av.Scalar("\n")
    if not isinstance(stream, av.Instance) or stream.type is not STREAM or slot is None:
        return _set_unknown_line(machine, arguments)
    text = stream.fields["text"]
    if not (isinstance(text, av.Scalar) and isinstance(separator, av.Scalar)):
        return _set_unknown_line(machine, arguments)
    line, _, rest = str(text.value).partition(str(separator.value))
    if not text.value:
        return av.Scalar(value=False)
    machine.undo_log.set(*slot, av.Scalar(line, text.tainted))
    machine.undo_log.set(stream.fields, "text", av.Scalar(rest, text.tainted))
    return av.Scalar(value=True)


def _set_unknown_line(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    slot = arguments.slot(1)
    if slot is not None:
        machine.undo_log.set(*slot, av.Unknown("line"))
    return av.Unknown("getline")


def _extract(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`stream >> word` of a known text."""
    text, slot = owner.fields["text"], arguments.slot(0)
    if not isinstance(text, av.Scalar) or slot is None:
        return av.Unknown("stream")
    word, _, rest = str(text.value).lstrip().partition(" ")
    if word:
        machine.undo_log.set(*slot, av.Scalar(word, text.tainted))
    machine.undo_log.set(owner.fields, "text", av.Scalar(rest, text.tainted))
    machine.undo_log.set(owner.fields, "truth", av.Scalar(bool(word)))
    return owner


def copy_string(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`strcpy(target, source)`."""
    slot = arguments.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, arguments.get(1) or av.Unknown("strcpy"))
    return arguments.get(1) or av.Unknown("strcpy")


STREAM = av.LibraryClass(
    "std::stringstream",
    _stream,
    {"operator<<": _write, "operator>>": _extract, "str": read_text, "toStdString": read_text},
)


def _change_text(
    function: Callable[..., object], _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """Return what a function makes of a text and the texts behind it, unknown unless all are."""
    words = [value.value for value in arguments.values[1:] if isinstance(value, av.Scalar)]
    all_known = len(words) == len(arguments.values) - 1

    def changed(value: av.Value) -> av.Value:
        if all_known and isinstance(value, av.Scalar) and isinstance(value.value, str):
            return av.Scalar(function(value.value, *map(str, words)), value.tainted)
        return av.Unknown("text", av.is_tainted(value))

    return av.map_options(arguments.value(0), changed)


def _in_place(
    change: Callable[..., str], machine: AbstractMachine, owner: object, arguments: Arguments
) -> av.Value:
    """`boost::to_upper(text)`: the text itself changes."""
    slot = arguments.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, _change_text(change, machine, owner, arguments))
    return av.NONE


def _join(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`boost::algorithm::join(words, separator)`."""
    items, certain = av.items_of(arguments.get(0) or av.NONE)
    separator = arguments.get(1) or av.Scalar("")
    spread = [part for item in items for part in (separator, item)]
    return av.concat(spread[1:]) if certain else av.Unknown("join")


def _split(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`boost::split(words, text, boost::is_any_of(" "))`."""
    words, text, separators = arguments.get(0), arguments.get(1), arguments.get(2)
    if not isinstance(words, av.ListValue):
        return av.NONE
    if not (isinstance(text, av.Scalar) and isinstance(separators, av.Scalar)):
        machine.undo_log.mark_open(words.fields)
        return words
    pieces = str(text.value)
    for letter in str(separators.value)[1:]:
        pieces = pieces.replace(letter, str(separators.value)[0])
    found = pieces.split(str(separators.value)[:1] or None)
    machine.undo_log.set(
        words.fields, "items", tuple(av.Scalar(piece, text.tainted) for piece in found)
    )
    return words


_CHANGES: Mapping[str, Callable[..., str]] = {
    "to_upper": str.upper,
    "to_lower": str.lower,
    "replace_all": str.replace,
    "trim": str.strip,
    "trim_left": str.lstrip,
    "trim_right": str.rstrip,
}
CHARACTER_FUNCTIONS: Mapping[str, LibraryCall] = {
    "strcmp": partial(_change_text, compare),
    **{
        f"{space}{name}": partial(_change_text, change)
        for space in ("", "::", "std::")
        for name, change in (("toupper", str.upper), ("tolower", str.lower))
    },
}
BOOST_STRINGS: Mapping[str, LibraryCall] = {
    **{f"{name}_copy": partial(_change_text, change) for name, change in _CHANGES.items()},
    **{name: partial(_in_place, change) for name, change in _CHANGES.items()},
    "starts_with": partial(_change_text, str.startswith),
    "ends_with": partial(_change_text, str.endswith),
    "contains": partial(_change_text, str.__contains__),
    "join": _join,
    "split": _split,
}


def _boost_format(_: AbstractMachine, arguments: Arguments) -> av.Value:
    return av.Instance(FORMAT, {"text": arguments.get(0) or av.Scalar("")})


def _fill_placeholder(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`boost::format("%s_%d") % a % b`: each % fills the next placeholder."""
    template = owner.fields["text"]
    if not isinstance(template, av.Scalar):
        return owner
    before, mark, after = str(template.value).partition("%")
    number = after[:1].isdigit() and after[1:2] == "%"
    spec, rest = ("s", after[2:]) if number else (after[:1], after[1:])
    filled = av.percent_format(
        av.Scalar(f"{before}{mark}{spec}"), av.list_of((arguments.get(0) or av.NONE,), "tuple")
    )
    return av.Instance(FORMAT, {"text": av.concat((filled, av.Scalar(rest)))})


def sprintf(offset: int, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`sprintf(buffer, format, …)`, `snprintf(buffer, size, format, …)`."""
    slot, format = arguments.slot(0), arguments.get(offset)
    if slot is None or format is None:
        return av.Unknown("sprintf")
    text = av.percent_format(format, av.list_of(arguments.values[offset + 1 :], "tuple"))
    machine.undo_log.set(*slot, text)
    return av.Unknown("sprintf")


def format_fields(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::format("{}_{:02d}", name, 3)`, {fmt}'s too; the fields are as in Python's str.format.

    cppreference.com: Standard format specification.
    """
    values = (av.map_options(value, _as_written) for value in arguments.values[1:])
    given = arguments.with_values(*values)
    return av.map_options(arguments.value(0), lambda text: fill_fields(machine, text, given))


def _as_written(value: av.Value) -> av.Value:
    """Return a value as C++ writes it: `true`."""
    if isinstance(value, av.Scalar) and isinstance(value.value, bool):
        return av.Scalar(str(value.value).lower(), value.tainted)
    return value


FORMAT = av.LibraryClass(
    "boost::format",
    _boost_format,
    {"operator%": _fill_placeholder, "str": read_text, "toStdString": read_text},
)


_TEXT, _STATE = "file.text", "truth"
_NOT_READ = av.Unknown("file")


def _open_file(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`std::ifstream file(path)`."""
    made = av.Instance(FILE, {_TEXT: _NOT_READ, _STATE: _NOT_READ})
    if arguments.values:
        _read_file(machine, made, arguments)
    return made


def _read_file(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`file.open(path)`."""

    def text_of(path: av.Value) -> av.Value:
        if not (isinstance(path, av.Scalar) and av.is_text(path)):
            return _NOT_READ
        found = machine.runtime.files.read_text(Path(str(path.value)))
        return _NOT_READ if found is None else av.Scalar(found)

    text = av.map_options(arguments.value(0), text_of)
    machine.undo_log.set(owner.fields, _TEXT, text)
    machine.undo_log.set(owner.fields, _STATE, av.TRUE if _is_known(text) else _NOT_READ)
    return av.NONE


def _is_known(text: av.Value) -> bool:
    return all(isinstance(option, av.Scalar) for option in av.options(text))


def _failed(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    """`file.fail()`."""
    return av.Scalar(value=False) if owner.fields[_STATE] == av.TRUE else _NOT_READ


def make_buffer_iterator(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`std::istreambuf_iterator<char>(file)`, of which with an end a text is made."""
    file = arguments.get(0)
    return file.fields[_TEXT] if isinstance(file, av.Instance) and file.type is FILE else av.NONE


FILE = av.LibraryClass(
    "std::ifstream",
    _open_file,
    {
        "open": _read_file,
        **dict.fromkeys(("good", "is_open"), returning_field(_STATE)),
        **dict.fromkeys(("fail", "bad", "operator!"), _failed),
        "rdbuf": returning_field(_TEXT),
    },
)
