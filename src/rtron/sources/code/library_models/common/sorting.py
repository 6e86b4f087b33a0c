"""Python's order of items: `sorted` and `list.sort`."""

from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch

Items = tuple[av.Value, ...]


def sort_items(machine: AbstractMachine, items: Items, arguments: Arguments) -> Items:
    """Return items sorted by `key` and `reverse`; as they are where that cannot be known."""
    keys = _sort_keys(machine, items, arguments)
    backwards = av.truth(arguments.keywords.get("reverse") or av.FALSE)
    if backwards is None:
        return items
    try:
        plain = [_comparable(key) for key in keys]
        order = sorted(range(len(items)), key=plain.__getitem__, reverse=backwards)
    except TypeError:
        return items
    return tuple(items[index] for index in order)


def _sort_keys(machine: AbstractMachine, items: Items, at: Arguments) -> Items:
    function = at.keywords.get("key", av.NONE)
    if function == av.NONE:
        return items
    return tuple(dispatch(machine, function, at.with_values(item)) for item in items)


def _comparable(key: av.Value) -> Any:  # noqa: ANN401
    """Return what Python compares; a TypeError where it is not known."""
    if isinstance(key, av.ListValue) and not key.open:
        return tuple(_comparable(item) for item in key.items)
    if isinstance(key, av.Scalar):
        return key.value
    raise TypeError(key)
