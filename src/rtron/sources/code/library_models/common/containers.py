"""Methods of lists, dicts and the containers of C++."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, listed, pair
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    OPEN,
    ClassValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    Value,
    join,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import remove
from rtron.sources.code.library_models.common.sorting import in_order

MAX_ITEMS = 1024
Methods = Mapping[str, Callable[..., Value]]


def _write(machine: Machine, owner: ListValue, items: tuple[Value, ...]) -> Value:
    machine.trail.set(owner.fields, "items", items[:MAX_ITEMS])
    if len(items) > MAX_ITEMS:
        machine.trail.open(owner.fields)
    return NONE


def _append(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    item = arguments.get(0) or NONE
    return _write(machine, owner, (*owner.items, item))


def _append_left(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    return _write(machine, owner, (arguments.get(0) or NONE, *owner.items))


def _push(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    """`push_back`: an object of a class is copied, as C++ does."""
    item = arguments.get(0) or NONE
    item = item if id(item) in machine.shared else copied(item)
    return _write(machine, owner, (*owner.items, item))


def copied(value: Value) -> Value:
    """Return a C++ object of a scanned class as a new one, members and all."""
    if isinstance(value, Instance) and isinstance(value.type, ClassValue):
        return Instance(value.type, dict(value.fields), value.types, value.bindings)
    return value


def _extend(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    if not certain:
        machine.trail.open(owner.fields)
    return _write(machine, owner, (*owner.items, *items))


def _insert(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    place = arguments.get(0)
    if arguments.get(1) and isinstance(place, Known) and isinstance(place.value, int):
        before, after = owner.items[: place.value], owner.items[place.value :]
        return _write(machine, owner, (*before, arguments.get(1) or NONE, *after))
    return _write(machine, owner, (*owner.items, arguments.get(1) or arguments.get(0) or NONE))


def _pop(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    key = arguments.get(0) or Known(-1)
    found = element(owner, key) if owner.items else Hole("pop")
    remove(machine, owner, key)
    return found


def _remove_item(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    wanted = arguments.get(0)
    if wanted in owner.items and isinstance(wanted, Known):
        remove(machine, owner, Known(owner.items.index(wanted)))
    return NONE


def _pop_entry(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    found = _get(machine, owner, arguments)
    remove(machine, owner, arguments.get(0) or Hole("?"))
    return found


def _clear_map(machine: Machine, owner: MapValue, _: Arguments) -> Value:
    for key in list(owner.fields):
        machine.trail.remove(owner.fields, key)
    return NONE


def _clear(machine: Machine, owner: ListValue, _: Arguments) -> Value:
    return _write(machine, owner, ())


def _size(_: Machine, owner: ListValue, __: Arguments) -> Value:
    return Hole("size") if owner.open else Known(len(owner.items))


def _empty(_: Machine, owner: ListValue, __: Arguments) -> Value:
    return (
        Known(value=False) if owner.items else (Hole("empty") if owner.open else Known(value=True))
    )


def _at(_: Machine, owner: ListValue, arguments: Arguments) -> Value:
    return element(owner, arguments.get(0) or Known(0))


def _last(_: Machine, owner: ListValue, __: Arguments) -> Value:
    return element(owner, Known(-1))


def _resize(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    count, fill = arguments.get(0), arguments.get(1) or Hole("item")
    if not (isinstance(count, Known) and isinstance(count.value, int)):
        machine.trail.open(owner.fields)
        return NONE
    items = (*owner.items, *[fill] * min(count.value, MAX_ITEMS))
    return _write(machine, owner, items[: max(0, count.value)])


def _copied(_: Machine, owner: ListValue, __: Arguments) -> Value:
    return ListValue(dict(owner.fields), owner.kind)


def _nothing(_: Machine, __: Value, ___: Arguments) -> Value:
    return NONE


def _sort(machine: Machine, owner: ListValue, arguments: Arguments) -> Value:
    machine.escape(arguments.get(0))
    if owner.open:
        machine.escape(arguments.keywords.get("key"))
    return _write(machine, owner, in_order(machine, owner.items, arguments))


def _reverse(machine: Machine, owner: ListValue, _: Arguments) -> Value:
    return _write(machine, owner, owner.items[::-1])


def _get(_: Machine, owner: MapValue, arguments: Arguments) -> Value:
    key, default = arguments.get(0) or Hole("?"), arguments.get(1) or NONE
    if isinstance(key, Known) and key.value not in owner.entries:
        return join([default, owner.fields[OPEN]]) if owner.open else default
    return element(owner, key)


def _keys(_: Machine, owner: MapValue, __: Arguments) -> Value:
    return ListValue({"items": items_of(owner)[0], "open": owner.open})


def _values(_: Machine, owner: MapValue, __: Arguments) -> Value:
    return ListValue({"items": tuple(owner.entries.values()), "open": owner.open})


def _items(_: Machine, owner: MapValue, __: Arguments) -> Value:
    keys, _certain = items_of(owner)
    rows = zip(keys, owner.entries.values(), strict=True)
    pairs = tuple(listed(row, "tuple") for row in rows)
    return ListValue({"items": pairs, "open": owner.open})


def _update(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    given = arguments.get(0)
    fields = dict(given.fields) if isinstance(given, MapValue) else {}
    for key, value in {**fields, **arguments.keywords}.items():
        machine.trail.set(owner.fields, key, value)
    return NONE


def _set_default(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.get(0)
    if isinstance(key, Known) and key.value not in owner.fields:
        machine.trail.set(owner.fields, key.value, arguments.get(1) or NONE)
    return element(owner, key or Hole("?"))


def _has_key(_: Machine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.get(0)
    if isinstance(key, Known):
        found = key.value in owner.entries
        return Known(found) if found or not owner.open else Hole("has_key")
    return Hole("has_key")


def _count(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    found = _has_key(machine, owner, arguments)
    return Known(int(found.value)) if isinstance(found, Known) else found


def _insert_pair(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    items, _ = items_of(arguments.get(0) or Hole("?"))
    if len(arguments.values) > 1:
        items = arguments.values
    key, value = (*items, Hole("?"), Hole("?"))[:2]
    machine.trail.set(owner.fields, key.value if isinstance(key, Known) else OPEN, value)
    return NONE


def _find_pair(machine: Machine, owner: MapValue, arguments: Arguments) -> Value:
    key = arguments.get(0)
    found = _has_key(machine, owner, arguments)
    if isinstance(found, Known) and isinstance(key, Known):
        return pair(key, owner.fields[key.value]) if found.value else _END
    return Hole("find")


def _end(_: Machine, __: Value, ___: Arguments) -> Value:
    return _END


def _map_size(_: Machine, owner: MapValue, __: Arguments) -> Value:
    return Hole("size") if owner.open else Known(len(owner.entries))


def _map_empty(_: Machine, owner: MapValue, __: Arguments) -> Value:
    return (
        Known(value=False)
        if owner.entries
        else (Hole("empty") if owner.open else Known(value=True))
    )


_END = Known("end()")

LIST: Methods = {
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
    "copy": _copied,
    "data": _copied,
    "remove": _remove_item,
    "discard": _remove_item,
    "pop_back": _pop,
    "pop_front": lambda machine, owner, arguments: _pop(
        machine, owner, Arguments(values=(Known(0),), frame=arguments.frame)
    ),
    "reserve": _nothing,
    "reverse": _reverse,
    "sort": _sort,
}
PYTHON_MAP: Methods = {
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
}
CPP_MAP: Methods = {
    "at": partial(_get),
    "count": _count,
    "contains": _has_key,
    "insert": _insert_pair,
    "emplace": _insert_pair,
    "find": _find_pair,
    "end": _end,
    "size": _map_size,
    "empty": _map_empty,
    "hasMember": _has_key,
    "erase": _pop_entry,
    "clear": _clear_map,
}


def bound(methods: Methods, owner: Value, name: str) -> Value | None:
    """Return a method of a container, bound to it."""
    call = methods.get(name)
    return Native(name, call, owner) if call is not None else None
