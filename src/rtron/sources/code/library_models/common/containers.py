"""Methods of lists, dicts and the containers of C++."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import (
    PAIR,
    items_of,
    key_value,
    list_of,
    pair_of,
)
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    OPEN,
    UNKNOWN,
    ClassValue,
    ExternalSymbol,
    Instance,
    LibraryFunction,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    is_tainted,
    join,
    map_key,
    text_with_holes,
    truth,
)
from rtron.sources.code.interpreter.cpp.braces import default_item, is_braces, make_item
from rtron.sources.code.interpreter.cpp.iterators import (
    ITERATOR,
    dereference,
    end,
    is_end,
    items_after,
    iterator_to,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import OPEN_KEYWORD, Arguments
from rtron.sources.code.interpreter.execution.assignment import remove_element
from rtron.sources.code.library_models.common.sorting import sort_items
from rtron.sources.code.library_models.common.trivial_functions import return_none

MAX_ITEMS = 1024
LibraryMethods = Mapping[str, Callable[..., Value]]


def _write(machine: AbstractMachine, owner: ListValue, items: tuple[Value, ...]) -> Value:
    machine.undo_log.set(owner.fields, "items", items[:MAX_ITEMS])
    if len(items) > MAX_ITEMS:
        machine.undo_log.mark_open(owner.fields)
    return NONE


def _append(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    item = arguments.get(0) or NONE
    return _write(machine, owner, (*owner.items, item))


def _append_left(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    return _write(machine, owner, (arguments.get(0) or NONE, *owner.items))


def _push(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    """`push_back`: an object of a class is copied, as C++ does."""
    return _write(machine, owner, (*owner.items, _new_item(machine, owner, arguments)))


def _push_front(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    return _write(machine, owner, (_new_item(machine, owner, arguments), *owner.items))


def _emplace(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    """`emplace(args…)` of a set, `emplace(position, args…)` of a vector."""
    first = arguments.get(0)
    positioned = isinstance(first, Instance) and first.type is ITERATOR
    return _push(machine, owner, arguments.without_first(1) if positioned else arguments)


def _new_item(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    item = make_item(machine, owner, arguments)
    return item if id(item) in machine.pointer_held else copy_instance(item)


def copy_instance(value: Value) -> Value:
    """Return a C++ object of a scanned class as a new one, members and all."""
    if isinstance(value, Instance) and isinstance(value.type, ClassValue):
        return Instance(value.type, dict(value.fields), value.types, value.bindings)
    return value


def _extend(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.value(0))
    if not certain:
        machine.undo_log.mark_open(owner.fields)
    return _write(machine, owner, (*owner.items, *items))


def _insert(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    index = arguments.get(0)
    if owner.type is not None:
        return _insert_cpp(machine, owner, arguments)
    if arguments.get(1) and isinstance(index, Scalar) and isinstance(index.value, int):
        before, after = owner.items[: index.value], owner.items[index.value :]
        return _write(machine, owner, (*before, arguments.get(1) or NONE, *after))
    return _write(machine, owner, (*owner.items, arguments.get(1) or arguments.get(0) or NONE))


def _insert_cpp(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    """`insert([position,] value)`, `insert([position,] first, last)`, of another container."""
    ranged = [items_after(value) for value in arguments.values[-2:-1]]
    if ranged and ranged[0] is not None and is_end(arguments.values[-1]):
        items, certain = ranged[0]
        if not certain:
            machine.undo_log.mark_open(owner.fields)
        return _write(machine, owner, (*owner.items, *(item for _, item in items)))
    last = arguments.without_first(len(arguments.values) - 1)
    return _write(machine, owner, (*owner.items, *_inserted(machine, owner, last)))


def _inserted(machine: AbstractMachine, owner: ListValue, last: Arguments) -> tuple[Value, ...]:
    """Return the items that the last argument of an insertion is; braces may hold several."""
    given = last.get(0)
    if isinstance(given, ListValue) and is_braces(given):
        return tuple(_new_item(machine, owner, last.with_values(item)) for item in given.items)
    return (_new_item(machine, owner, last),)


def _assign(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    """`assign(first, last)`, `assign({…})`, `assign(count, value)`."""
    count, given = arguments.get(0), arguments.get(1)
    _clear(machine, owner, arguments)
    if isinstance(count, Scalar) and isinstance(count.value, int):
        return _write(machine, owner, (given or UNKNOWN,) * max(0, min(count.value, MAX_ITEMS)))
    return _insert_cpp(machine, owner, arguments)


def _swap(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    other = arguments.get(0)
    if not isinstance(other, ListValue):
        machine.undo_log.mark_open(owner.fields)
        return NONE
    items, opened = owner.items, owner.open
    machine.undo_log.set(owner.fields, "open", other.open)
    machine.undo_log.set(other.fields, "open", opened)
    before = other.items
    _write(machine, other, items)
    return _write(machine, owner, before)


def _pop(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    first = owner.type is not None and owner.type.name == "std::queue"
    key = arguments.get(0) or Scalar(0 if first else -1)
    found = element(owner, key) if owner.items else Unknown("pop")
    remove_element(machine, owner, key)
    return found


def _remove_item(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    item = arguments.get(0)
    if item in owner.items and isinstance(item, Scalar):
        remove_element(machine, owner, Scalar(owner.items.index(item)))
    return NONE


def _pop_entry(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    """`pop(key)` of a dict, `erase(key)` and `erase(iterator)` of a std::map."""
    found, pointed = _get(machine, owner, arguments), dereference(arguments.value(0))
    is_entry = isinstance(pointed, Instance) and pointed.type is PAIR
    remove_element(machine, owner, items_of(pointed)[0][0] if is_entry else pointed)
    return found


def _clear_map(machine: AbstractMachine, owner: MapValue, _: Arguments) -> Value:
    for key in list(owner.fields):
        machine.undo_log.remove(owner.fields, key)
    return NONE


def _clear(machine: AbstractMachine, owner: ListValue, _: Arguments) -> Value:
    return _write(machine, owner, ())


def _size(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    items, certain = items_of(owner)
    return Scalar(len(items)) if certain else Unknown("size")


def _empty(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    filled = truth(owner)
    return Unknown("empty") if filled is None else Scalar(not filled)


def _at(_: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    return element(owner, arguments.get(0) or Scalar(0))


def _last(_: AbstractMachine, owner: ListValue, __: Arguments) -> Value:
    return element(owner, Scalar(-1))


def _resize(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    count, fill = arguments.get(0), arguments.get(1)
    if not (isinstance(count, Scalar) and isinstance(count.value, int)):
        machine.undo_log.mark_open(owner.fields)
        return NONE
    size = max(0, min(count.value, MAX_ITEMS + 1))
    more = size - len(owner.items)
    added = [fill or default_item(machine, owner, arguments.frame) for _ in range(more)]
    return _write(machine, owner, (*owner.items, *added)[:size])


def _copy(_: AbstractMachine, owner: ListValue, __: Arguments) -> Value:
    return replace(owner, fields=dict(owner.fields))


def _sort(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    machine.escape(arguments.get(0))
    if owner.open:
        machine.escape(arguments.keywords.get("key"))
    return _write(machine, owner, sort_items(machine, owner.items, arguments))


def _reverse(machine: AbstractMachine, owner: ListValue, _: Arguments) -> Value:
    return _write(machine, owner, owner.items[::-1])


def _get(_: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    key, default = arguments.value(0), arguments.get(1, "default") or NONE
    name = owner.key_of(key)
    if name is not OPEN and name not in owner.entries:
        return join([default, owner.fields[OPEN]]) if owner.open else default
    return element(owner, key)


def _keys(_: AbstractMachine, owner: MapValue, __: Arguments) -> Value:
    return list_of(items_of(owner)[0], certain=not owner.open)


def _values(_: AbstractMachine, owner: MapValue, __: Arguments) -> Value:
    return list_of(owner.entries.values(), certain=not owner.open)


def _items(_: AbstractMachine, owner: MapValue, __: Arguments) -> Value:
    keys, _certain = items_of(owner)
    rows = zip(keys, owner.entries.values(), strict=True)
    pairs = tuple(list_of(row, "tuple") for row in rows)
    return list_of(pairs, certain=not owner.open)


def _update(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    """`update(other, **more)`: what is not known of another may replace any text or number."""
    given = arguments.get(0)
    made = dict_of(given) if given is not None else MapValue()
    if made.open or OPEN_KEYWORD in arguments.keywords:
        for name, value in owner.entries.items():
            if isinstance(value, (Scalar, PartialText)):
                machine.undo_log.set(owner.fields, name, Unknown(str(name), is_tainted(value)))
    for key, value in {**made.fields, **keyword_fields(arguments)}.items():
        if not (owner.is_namespace and key is OPEN):
            machine.undo_log.set(owner.fields, key, value)
    return NONE


def dict_of(given: Value) -> MapValue:
    """Return the dict that a mapping or the pairs of a sequence make."""
    if isinstance(given, MapValue):
        return MapValue(dict(given.fields))
    items, certain = items_of(given)
    made = MapValue({} if certain else {OPEN: UNKNOWN})
    for item in items:
        key, value = (*items_of(item)[0], UNKNOWN, UNKNOWN)[:2]
        made.fields[map_key(key)] = value
    return made


def keyword_fields(arguments: Arguments) -> dict[Any, Value]:
    """Return the arguments by name as the entries of a dict."""
    words = dict(arguments.keywords)
    rest = words.pop(OPEN_KEYWORD, None)
    return words if rest is None else {**words, OPEN: rest}


def _copy_map(_: AbstractMachine, owner: MapValue, __: Arguments) -> Value:
    return MapValue(dict(owner.fields), owner.iterates_pairs, owner.default_factory)


def _pop_last_entry(machine: AbstractMachine, owner: MapValue, _: Arguments) -> Value:
    """`popitem()`."""
    if not owner.entries:
        return Unknown("popitem")
    key, value = list(owner.entries.items())[-1]
    machine.undo_log.remove(owner.fields, key)
    return list_of((key_value(key), value), "tuple")


def _set_default(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.value(0)
    name = owner.key_of(key)
    if name is OPEN:
        machine.undo_log.set(owner.fields, OPEN, Unknown(text_with_holes(key).strip("{}")))
    elif name not in owner.fields:
        machine.undo_log.set(owner.fields, name, arguments.get(1) or NONE)
    return element(owner, key)


def _has_key(_: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    name = owner.key_of(arguments.value(0))
    if name is OPEN:
        return Unknown("has_key")
    found = name in owner.entries
    return Scalar(found) if found or not owner.open else Unknown("has_key")


def _count(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    found = _has_key(machine, owner, arguments)
    return Scalar(int(found.value)) if isinstance(found, Scalar) else found


def _insert_pair(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    """`insert(pair)`, `emplace(key, args…)`, `insert({{key, value}, …})`: what is there stays."""
    items, _ = items_of(arguments.value(0))
    if len(arguments.values) > 1:
        return _emplace_entry(machine, owner, arguments)
    if items and all(isinstance(item, ListValue) for item in items):
        for item in items:
            _insert_pair(machine, owner, arguments.with_values(item))
        return NONE
    return _emplace_entry(machine, owner, arguments.with_values(*items[:1], *items[1:2]))


def _emplace_entry(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    if isinstance(arguments.value(0), ExternalSymbol):
        parts = [items_of(value)[0] for value in arguments.values[1:]]
        arguments = arguments.with_values(*(item for part in parts for item in part))
    key, rest = arguments.value(0), arguments.without_first(1)
    is_new = owner.key_of(key) not in owner.entries
    if is_new:
        _set_entry(machine, owner, key, rest)
    entry = element(owner, key)
    return pair_of(pair_of(key, entry), Scalar(is_new))


def _insert_or_assign(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    _set_entry(machine, owner, arguments.value(0), arguments.without_first(1))
    return NONE


def _set_entry(machine: AbstractMachine, owner: MapValue, key: Value, rest: Arguments) -> None:
    if rest.values or owner.default_factory is None:
        value = make_item(machine, owner, rest) if rest.values else UNKNOWN
    else:
        value = owner.default_factory()
    machine.undo_log.set(owner.fields, owner.key_of(key), value)


def _find_pair(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.get(0)
    found = _has_key(machine, owner, arguments)
    if not (isinstance(found, Scalar) and isinstance(key, Scalar)):
        return Unknown("find")
    if not found.value:
        return end(machine, owner, arguments)
    position = list(owner.entries).index(key.value)
    return iterator_to(machine, owner, position, arguments)


LIST_METHODS: LibraryMethods = {
    "append": _append,
    "add": _append,
    "appendleft": _append_left,
    "push_back": _push,
    "emplace_back": _push,
    "push_front": _push_front,
    "emplace_front": _push_front,
    "emplace": _emplace,
    "push": _push,
    "extend": _extend,
    "update": _extend,
    "insert": _insert,
    "assign": _assign,
    "swap": _swap,
    "pop": _pop,
    "clear": _clear,
    "size": _size,
    "empty": _empty,
    "at": _at,
    "front": _at,
    "back": _last,
    "top": _last,
    "resize": _resize,
    "copy": _copy,
    "data": _copy,
    "remove": _remove_item,
    "discard": _remove_item,
    "pop_back": _pop,
    "pop_front": lambda machine, owner, arguments: _pop(
        machine, owner, arguments.with_values(Scalar(0))
    ),
    "reserve": return_none,
    "reverse": _reverse,
    "sort": _sort,
}
DICT_METHODS: LibraryMethods = {
    "get": _get,
    "keys": _keys,
    "values": _values,
    "items": _items,
    "iterkeys": _keys,
    "itervalues": _values,
    "iteritems": _items,
    "update": _update,
    "setdefault": _set_default,
    "has_key": _has_key,
    "pop": _pop_entry,
    "clear": _clear_map,
    "copy": _copy_map,
    "popitem": _pop_last_entry,
    "__contains__": _has_key,
}
CPP_MAP_METHODS: LibraryMethods = {
    "at": _get,
    "count": _count,
    "contains": _has_key,
    "insert": _insert_pair,
    "emplace": _insert_pair,
    "try_emplace": _insert_pair,
    "insert_or_assign": _insert_or_assign,
    "find": _find_pair,
    "size": _size,
    "empty": _empty,
    "hasMember": _has_key,
    "erase": _pop_entry,
    "clear": _clear_map,
}


def bound_method(methods: LibraryMethods, owner: Value, name: str) -> Value | None:
    """Return a method of a container, bound to it."""
    call = methods.get(name)
    return LibraryFunction(name, call, owner) if call is not None else None
