"""Methods of lists, dicts and the containers of C++."""

from collections.abc import Callable, Mapping
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import (
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
    item = arguments.get(0) or NONE
    item = item if id(item) in machine.pointer_held else copy_instance(item)
    return _write(machine, owner, (*owner.items, item))


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
    if arguments.get(1) and isinstance(index, Scalar) and isinstance(index.value, int):
        before, after = owner.items[: index.value], owner.items[index.value :]
        return _write(machine, owner, (*before, arguments.get(1) or NONE, *after))
    return _write(machine, owner, (*owner.items, arguments.get(1) or arguments.get(0) or NONE))


def _pop(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    key = arguments.get(0) or Scalar(-1)
    found = element(owner, key) if owner.items else Unknown("pop")
    remove_element(machine, owner, key)
    return found


def _remove_item(machine: AbstractMachine, owner: ListValue, arguments: Arguments) -> Value:
    item = arguments.get(0)
    if item in owner.items and isinstance(item, Scalar):
        remove_element(machine, owner, Scalar(owner.items.index(item)))
    return NONE


def _pop_entry(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    found = _get(machine, owner, arguments)
    remove_element(machine, owner, arguments.value(0))
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
    count, fill = arguments.get(0), arguments.get(1) or Unknown("item")
    if not (isinstance(count, Scalar) and isinstance(count.value, int)):
        machine.undo_log.mark_open(owner.fields)
        return NONE
    items = (*owner.items, *[fill] * min(count.value, MAX_ITEMS))
    return _write(machine, owner, items[: max(0, count.value)])


def _copy(_: AbstractMachine, owner: ListValue, __: Arguments) -> Value:
    return ListValue(dict(owner.fields), owner.kind)


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
    items, _ = items_of(arguments.value(0))
    if len(arguments.values) > 1:
        items = arguments.values
    key, value = (*items, UNKNOWN, UNKNOWN)[:2]
    machine.undo_log.set(owner.fields, key.value if isinstance(key, Scalar) else OPEN, value)
    return NONE


def _find_pair(machine: AbstractMachine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.get(0)
    found = _has_key(machine, owner, arguments)
    if isinstance(found, Scalar) and isinstance(key, Scalar):
        return pair_of(key, owner.fields[key.value]) if found.value else _END
    return Unknown("find")


def _end(_: AbstractMachine, __: Value, ___: Arguments) -> Value:
    return _END


_END = Scalar("end()")

LIST_METHODS: LibraryMethods = {
    "append": _append,
    "add": _append,
    "appendleft": _append_left,
    "push_back": _push,
    "emplace_back": _push,
    "push": _push,
    "extend": _extend,
    "update": _extend,
    "insert": _insert,
    "pop": _pop,
    "clear": _clear,
    "size": _size,
    "empty": _empty,
    "at": _at,
    "front": _at,
    "back": _last,
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
    "find": _find_pair,
    "end": _end,
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
