"""Texts that C++ makes of a format and values: printf, Boost, std, {fmt} and Abseil."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.strings import fill_fields
from rtron.sources.code.library_models.cpp_std.strings import read_text


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


def format_printf(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`absl::StrFormat("%s_%d", name, 3)`, `fmt::sprintf`."""
    return av.percent_format(arguments.value(0), av.list_of(arguments.values[1:], "tuple"))


def concatenate(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`absl::StrCat("scan_", 1)`."""
    return av.concat(arguments.values)


FORMAT = av.LibraryClass(
    "boost::format",
    _boost_format,
    {"operator%": _fill_placeholder, "str": read_text, "toStdString": read_text},
)
