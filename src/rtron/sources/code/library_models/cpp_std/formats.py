"""Texts that C++ makes of a format and values: printf, Boost, std, {fmt} and Abseil."""

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.operators import percent_format
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    concat,
    map_options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.strings import fill_fields
from rtron.sources.code.library_models.cpp_std.strings import read_text


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


def format_fields(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`std::format("{}_{:02d}", name, 3)`, {fmt}'s too; the fields are as in Python's str.format.

    cppreference.com: Standard format specification.
    """
    values = (map_options(value, _as_written) for value in arguments.values[1:])
    given = arguments.with_values(*values)
    return map_options(arguments.value(0), lambda text: fill_fields(machine, text, given))


def _as_written(value: Value) -> Value:
    """Return a value as C++ writes it: `true`."""
    if isinstance(value, Scalar) and isinstance(value.value, bool):
        return Scalar(str(value.value).lower(), value.tainted)
    return value


def format_printf(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`absl::StrFormat("%s_%d", name, 3)`, `fmt::sprintf`."""
    return percent_format(arguments.value(0), list_of(arguments.values[1:], "tuple"))


def concatenate(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`absl::StrCat("scan_", 1)`."""
    return concat(arguments.values)


FORMAT = LibraryClass(
    "boost::format",
    _boost_format,
    {"operator%": _fill_placeholder, "str": read_text, "toStdString": read_text},
)
