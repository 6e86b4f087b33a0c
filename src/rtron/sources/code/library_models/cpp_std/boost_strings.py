"""Boost's string algorithms (boost.org: String Algorithms Library), on text that may be unknown."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall


def _result(
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
        machine.undo_log.set(*slot, _result(change, machine, owner, arguments))
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


def _without(text: str, part: str) -> str:
    return text.replace(part, "")


def _replace_first(text: str, old: str, new: str) -> str:
    return text.replace(old, new, 1)


_CHANGES: Mapping[str, Callable[..., str]] = {
    "to_upper": str.upper,
    "to_lower": str.lower,
    "replace_all": str.replace,
    "replace_first": _replace_first,
    "erase_all": _without,
    "trim": str.strip,
    "trim_left": str.lstrip,
    "trim_right": str.rstrip,
}
_CHANGES_WHERE: Mapping[str, Callable[..., str]] = {
    "trim": str.strip,
    "trim_left": str.lstrip,
    "trim_right": str.rstrip,
}

BOOST_STRINGS: Mapping[str, LibraryCall] = {
    **{f"{name}_copy": partial(_result, change) for name, change in _CHANGES.items()},
    **{f"{name}_copy_if": partial(_result, change) for name, change in _CHANGES_WHERE.items()},
    **{name: partial(_in_place, change) for name, change in _CHANGES.items()},
    **{f"{name}_if": partial(_in_place, change) for name, change in _CHANGES_WHERE.items()},
    "starts_with": partial(_result, str.startswith),
    "ends_with": partial(_result, str.endswith),
    "contains": partial(_result, str.__contains__),
    "join": _join,
    "split": _split,
}
