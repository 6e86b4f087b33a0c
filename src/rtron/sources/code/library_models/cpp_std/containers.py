"""How the containers of C++ are made."""

from collections.abc import Callable
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.braces import default_item, is_braces, make_item
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR, is_end, items_after
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.containers import copy_instance

_SIZE_AND_FILL = 2
MAX_ITEMS = 256
_KEY_AND_VALUE = 2


def make_vector(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::vector: copied, filled, of a range, or of what stands in braces."""
    made = _typed_list(machine, arguments, "std::vector", arguments.types)
    _fill_vector(machine, made, arguments)
    return made


def make_queue(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::queue, which gives first what came first."""
    made = _typed_list(machine, arguments, "std::queue", arguments.types)
    _fill_vector(machine, made, arguments)
    return made


def make_multimap(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::multimap, a list of pairs: a key may stand in it several times."""
    pair = TypeRef("std::pair", arguments.types)
    made = _typed_list(machine, arguments, "std::multimap", (pair,))
    _fill_vector(machine, made, arguments)
    return made


def _typed_list(
    machine: AbstractMachine, arguments: Arguments, name: str, types: tuple[TypeRef, ...]
) -> av.ListValue:
    """Return an empty container that knows what its items are, in every scope."""
    full = cpp_runtime(machine).qualified_type(TypeRef(name, types), arguments.frame)
    return av.ListValue({"items": (), "open": False}, type=full)


def _fill_vector(machine: AbstractMachine, made: av.ListValue, arguments: Arguments) -> None:
    given, fill = arguments.get(0), arguments.get(1)
    ranged = items_after(given) if fill is not None and is_end(fill) else None
    if isinstance(given, av.ListValue):
        made.fields |= {**given.fields, "items": _convert_items(machine, made, given, arguments)}
    elif ranged is not None:
        made.fields |= {"items": tuple(item for _, item in ranged[0]), "open": not ranged[1]}
    elif _is_size(given) and len(arguments.values) <= _SIZE_AND_FILL:
        made.fields["items"] = _default_items(machine, made, given, arguments)
        made.fields["open"] = isinstance(given, av.Scalar) and given.value > MAX_ITEMS
    elif given is not None and all(_is_element(value) for value in arguments.values):
        made.fields["items"] = arguments.values
    else:
        made.fields["open"] = given is not None


def _is_size(value: av.Value | None) -> bool:
    return isinstance(value, av.Scalar) and isinstance(value.value, int)


def _default_items(
    machine: AbstractMachine, made: av.ListValue, size: av.Value | None, arguments: Arguments
) -> tuple[av.Value, ...]:
    """`std::vector<T> v(size)`, `v(size, fill)`: each item is an object of its own."""
    count = size.value if isinstance(size, av.Scalar) else 0
    fill = arguments.get(1)
    return tuple(
        default_item(machine, made, arguments.frame) if fill is None else copy_instance(fill)
        for _ in range(max(0, min(count, MAX_ITEMS)))
    )


def _convert_items(
    machine: AbstractMachine, made: av.Value, given: av.ListValue, arguments: Arguments
) -> tuple[av.Value, ...]:
    """Return what braces make of each item: `{"a", 1}` in a vector of pairs or structs."""
    return tuple(make_item(machine, made, arguments.with_values(item)) for item in given.items)


def _is_element(value: av.Value) -> bool:
    """`std::vector<std::string> v{"a", "b"}`: iterators and sizes are no items."""
    return av.is_text(value) or (isinstance(value, av.Instance) and value.type is not ITERATOR)


def make_map(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::map, of pairs in braces or of another map."""
    full = cpp_runtime(machine).qualified_type(
        TypeRef("std::map", arguments.types), arguments.frame
    )
    factory = _factory(machine, arguments)
    made = av.MapValue(iterates_pairs=True, default_factory=factory, type=full)
    given = arguments.get(0)
    if isinstance(given, av.MapValue):
        made.fields.update(given.fields)
        return made
    pairs, certain = _given_pairs(given, arguments)
    for item in pairs:
        key, value = (*av.items_of(item)[0], av.UNKNOWN, av.UNKNOWN)[:2]
        entry = make_item(machine, made, arguments.with_values(value))
        made.fields[made.key_of(key)] = entry
    if not certain:
        made.fields.setdefault(av.OPEN, av.UNKNOWN)
    return made


def _given_pairs(given: av.Value | None, arguments: Arguments) -> tuple[tuple[av.Value, ...], bool]:
    """Return the pairs that a map is made of, and whether these are all."""
    ranged = items_after(given)
    if ranged is not None:
        return tuple(item for _, item in ranged[0]), ranged[1]
    if given is None or len(arguments.values) > 1:
        return arguments.values, True
    return av.items_of(given)


def _factory(machine: AbstractMachine, arguments: Arguments) -> Callable[[], av.Value] | None:
    """`m[key]` makes a default of the mapped type where there is no entry (std::map)."""
    if len(arguments.types) < _KEY_AND_VALUE:
        return None
    return partial(cpp_runtime(machine).default_value, arguments.types[1], arguments.frame)


def make_array(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`T name[n]`, `std::array<T, n>`: what is given, and of the rest what T is by default."""
    types = arguments.types
    size = int(types[1].name) if len(types) > 1 and types[1].name.isdigit() else 0
    made = _typed_list(machine, arguments, "std::array", types)
    given = arguments.get(0)
    if isinstance(given, av.ListValue) and len(given.items) == 1 and size > 1:
        inner = given.items[0]
        given = inner if isinstance(inner, av.ListValue) and is_braces(inner) else given
    if isinstance(given, av.ListValue):
        made.fields |= {**given.fields, "items": _convert_items(machine, made, given, arguments)}
    missing = min(size, MAX_ITEMS) - len(made.items)
    more = [default_item(machine, made, arguments.frame) for _ in range(missing)]
    made.fields["items"] = (*made.items, *more)
    made.fields["open"] = made.open or size > MAX_ITEMS or not (made.items or size)
    return made


def make_pair(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::pair."""
    first, second = (*arguments.values, av.Unknown("first"), av.Unknown("second"))[:2]
    return av.pair_of(first, second)


def make_pair_function(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Return `std::make_pair(first, second)`."""
    return make_pair(machine, arguments)


def make_tuple(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::tuple."""
    return av.list_of(arguments.values, "tuple")


def get_tuple_item(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`std::get<0>(tuple)`; `std::get<T>(variant)`, which is what it holds."""
    at = arguments.types[0].name if arguments.types else ""
    if not at.isdigit() and not isinstance(arguments.get(0), av.ListValue):
        return arguments.value(0)
    items, _certain = av.items_of(arguments.get(0) or av.NONE)
    return items[int(at)] if at.isdigit() and int(at) < len(items) else av.Unknown("get")
