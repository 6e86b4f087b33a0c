"""How the containers of C++ are made."""

from collections.abc import Callable
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of, pair_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    OPEN,
    UNKNOWN,
    Instance,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    is_text,
)
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime

_SIZE_AND_FILL = 2


_KEY_AND_VALUE = 2


def _convert_item(
    machine: AbstractMachine, item: Value, arguments: Arguments, at: int = 0
) -> Value:
    """Return what braces make of an element: `{"a", 1}` in a vector of pairs or structs."""
    if not isinstance(item, ListValue) or len(arguments.types) <= at:
        return item
    inner = arguments.with_values(*item.items)
    made = cpp_runtime(machine).construct(arguments.types[at], inner)
    return item if isinstance(made, Unknown) else made


def make_vector(machine: AbstractMachine, arguments: Arguments) -> Value:
    """Make a std::vector: copied, filled, or of what stands in braces."""
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_convert_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    if (
        isinstance(given, Scalar)
        and isinstance(given.value, int)
        and len(arguments.values) <= _SIZE_AND_FILL
    ):
        fill = arguments.get(1) or Unknown("item")
        return list_of([fill] * max(0, min(given.value, 256)))
    if given is not None and all(_is_element(value) for value in arguments.values):
        return list_of(arguments.values)
    return list_of((), certain=given is None)


def _is_element(value: Value) -> bool:
    """`std::vector<std::string> v{"a", "b"}`: iterators and sizes are no items."""
    return is_text(value) or (isinstance(value, Instance) and value.type is not ITERATOR)


def make_map(machine: AbstractMachine, arguments: Arguments) -> Value:
    """Make a std::map, of pairs in braces or of another map."""
    made = MapValue(iterates_pairs=True, default_factory=_default_factory(machine, arguments))
    given = arguments.get(0)
    if isinstance(given, MapValue):
        return MapValue(
            dict(given.fields), iterates_pairs=True, default_factory=made.default_factory
        )
    pairs = items_of(given)[0] if given is not None and len(arguments.values) == 1 else ()
    for item in pairs or arguments.values:
        key, value = (*items_of(item)[0], UNKNOWN, UNKNOWN)[:2]
        entry = _convert_item(machine, value, arguments, 1)
        made.fields[key.value if isinstance(key, Scalar) else OPEN] = entry
    return made


def _default_factory(machine: AbstractMachine, arguments: Arguments) -> Callable[[], Value] | None:
    """`m[key]` makes a default of the mapped type where there is no entry (std::map)."""
    if len(arguments.types) < _KEY_AND_VALUE:
        return None
    return partial(cpp_runtime(machine).default_value, arguments.types[1], arguments.frame)


def make_array(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`T name[n]`: as many as it says of what T is by default."""
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_convert_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    types = arguments.types
    size = int(types[1].name) if len(types) > 1 and types[1].name.isdigit() else 0
    element: Value = Unknown("item")
    if types:
        element = cpp_runtime(machine).default_value(types[0], arguments.frame)
    return list_of((element,) * min(size, 64), certain=size > 0)


def make_pair(_: AbstractMachine, arguments: Arguments) -> Value:
    """Make a std::pair."""
    first, second = (*arguments.values, Unknown("first"), Unknown("second"))[:2]
    return pair_of(first, second)


def make_pair_function(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """Return `std::make_pair(first, second)`."""
    return make_pair(machine, arguments)


def get_tuple_item(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`std::get<0>(tuple)`."""
    at = arguments.types[0].name if arguments.types else ""
    items, _certain = items_of(arguments.get(0) or NONE)
    return items[int(at)] if at.isdigit() and int(at) < len(items) else Unknown("get")


CONTAINER_CONSTRUCTORS = (make_vector, make_map, make_array)
"""They take a list in braces whole; other classes take what stands in it."""
