"""How the containers of C++ are made."""

from collections.abc import Callable
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed, pair
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    OPEN,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Text,
    Value,
)
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp import cpp

_SIZE_AND_FILL = 2


_KEY_AND_VALUE = 2


def _as_item(machine: Machine, item: Value, arguments: Arguments, at: int = 0) -> Value:
    """Return what braces make of an element: `{"a", 1}` in a vector of pairs or structs."""
    if not isinstance(item, ListValue) or len(arguments.types) <= at:
        return item
    inner = Arguments(values=item.items, line=arguments.line, frame=arguments.frame)
    made = cpp(machine).make(arguments.types[at], inner)
    return item if isinstance(made, Hole) else made


def make_vector(machine: Machine, arguments: Arguments) -> Value:
    """Make a std::vector: copied, filled, or of what stands in braces."""
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_as_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    if (
        isinstance(given, Known)
        and isinstance(given.value, int)
        and len(arguments.values) <= _SIZE_AND_FILL
    ):
        fill = arguments.get(1) or Hole("item")
        return listed([fill] * max(0, min(given.value, 256)))
    if given is not None and all(_is_item(value) for value in arguments.values):
        return listed(arguments.values)
    return ListValue({"items": (), "open": given is not None})


def _is_item(value: Value) -> bool:
    """`std::vector<std::string> v{"a", "b"}`: iterators and sizes are no items."""
    if isinstance(value, Known):
        return isinstance(value.value, str)
    return isinstance(value, Text) or (isinstance(value, Instance) and value.type is not ITERATOR)


def make_map(machine: Machine, arguments: Arguments) -> Value:
    """Make a std::map, of pairs in braces or of another map."""
    made = MapValue(pairs=True, missing=_missing(machine, arguments))
    given = arguments.get(0)
    if isinstance(given, MapValue):
        return MapValue(dict(given.fields), pairs=True, missing=made.missing)
    pairs = items_of(given)[0] if given is not None and len(arguments.values) == 1 else ()
    for item in pairs or arguments.values:
        key, value = (*items_of(item)[0], Hole("?"), Hole("?"))[:2]
        entry = _as_item(machine, value, arguments, 1)
        made.fields[key.value if isinstance(key, Known) else OPEN] = entry
    return made


def _missing(machine: Machine, arguments: Arguments) -> Callable[[], Value] | None:
    """`m[key]` makes a default of the mapped type where there is no entry (std::map)."""
    if len(arguments.types) < _KEY_AND_VALUE:
        return None
    return partial(cpp(machine).default, arguments.types[1], arguments.frame)


def make_array(machine: Machine, arguments: Arguments) -> Value:
    """`T name[n]`: as many as it says of what T is by default."""
    given = arguments.get(0)
    if isinstance(given, ListValue):
        items = tuple(_as_item(machine, item, arguments) for item in given.items)
        return ListValue({**given.fields, "items": items})
    types = arguments.types
    size = int(types[1].name) if len(types) > 1 and types[1].name.isdigit() else 0
    element: Value = Hole("item")
    if types:
        element = cpp(machine).default(types[0], arguments.frame)
    return ListValue({"items": (element,) * min(size, 64), "open": size == 0})


def make_pair(_: Machine, arguments: Arguments) -> Value:
    """Make a std::pair."""
    first, second = (*arguments.values, Hole("first"), Hole("second"))[:2]
    return pair(first, second)


def call_make_pair(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Return `std::make_pair(first, second)`."""
    return make_pair(machine, arguments)


def get_item(_: Machine, __: object, arguments: Arguments) -> Value:
    """`std::get<0>(tuple)`."""
    at = arguments.types[0].name if arguments.types else ""
    items, _certain = items_of(arguments.get(0) or NONE)
    return items[int(at)] if at.isdigit() and int(at) < len(items) else Hole("get")
