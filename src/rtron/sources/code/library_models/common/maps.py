"""Methods of dicts and of the maps of C++."""

from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.braces import make_item
from rtron.sources.code.interpreter.cpp.iterators import begin, dereference, end, iterator_to
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import OPEN_KEYWORD, Arguments
from rtron.sources.code.interpreter.execution.assignment import remove_element
from rtron.sources.code.library_models.common import containers


def _pop_entry(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    """`pop(key)` of a dict, `erase(key)` and `erase(iterator)` of a std::map."""
    found, pointed = _get(machine, owner, arguments), dereference(arguments.value(0))
    is_entry = isinstance(pointed, av.Instance) and pointed.type is av.PAIR
    remove_element(machine, owner, av.items_of(pointed)[0][0] if is_entry else pointed)
    return found


def _clear_map(machine: AbstractMachine, owner: av.MapValue, _: Arguments) -> av.Value:
    for key in list(owner.fields):
        machine.undo_log.remove(owner.fields, key)
    return av.NONE


def _get(_: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    key, default = arguments.value(0), arguments.get(1, "default") or av.NONE
    name = owner.key_of(key)
    if name is not av.OPEN and name not in owner.entries:
        return av.join([default, owner.fields[av.OPEN]]) if owner.open else default
    return av.element(owner, key)


def _keys(_: AbstractMachine, owner: av.MapValue, __: Arguments) -> av.Value:
    return av.list_of(av.items_of(owner)[0], certain=not owner.open)


def _values(_: AbstractMachine, owner: av.MapValue, __: Arguments) -> av.Value:
    return av.list_of(owner.entries.values(), certain=not owner.open)


def _items(_: AbstractMachine, owner: av.MapValue, __: Arguments) -> av.Value:
    keys, _certain = av.items_of(owner)
    rows = zip(keys, owner.entries.values(), strict=True)
    pairs = tuple(av.list_of(row, "tuple") for row in rows)
    return av.list_of(pairs, certain=not owner.open)


def _update(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    """`update(other, **more)`: what is not known of another may replace any text or number."""
    given = arguments.get(0)
    made = dict_of(given) if given is not None else av.MapValue()
    if made.open or OPEN_KEYWORD in arguments.keywords:
        for name, value in owner.entries.items():
            if isinstance(value, (av.Scalar, av.PartialText)):
                machine.undo_log.set(
                    owner.fields, name, av.Unknown(str(name), av.is_tainted(value))
                )
    for key, value in {**made.fields, **keyword_fields(arguments)}.items():
        if not (owner.is_namespace and key is av.OPEN):
            machine.undo_log.set(owner.fields, key, value)
    return av.NONE


def dict_of(given: av.Value) -> av.MapValue:
    """Return the dict that a mapping or the pairs of a sequence make."""
    if isinstance(given, av.MapValue):
        return av.MapValue(dict(given.fields))
    items, certain = av.items_of(given)
    made = av.MapValue({} if certain else {av.OPEN: av.UNKNOWN})
    for item in items:
        key, value = (*av.items_of(item)[0], av.UNKNOWN, av.UNKNOWN)[:2]
        made.fields[av.map_key(key)] = value
    return made


def keyword_fields(arguments: Arguments) -> dict[Any, av.Value]:
    """Return the arguments by name as the entries of a dict."""
    words = dict(arguments.keywords)
    rest = words.pop(OPEN_KEYWORD, None)
    return words if rest is None else {**words, av.OPEN: rest}


def _set_default(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    key = arguments.value(0)
    name = owner.key_of(key)
    if name is av.OPEN:
        machine.undo_log.set(owner.fields, av.OPEN, av.Unknown(av.text_with_holes(key).strip("{}")))
    elif name not in owner.fields:
        machine.undo_log.set(owner.fields, name, arguments.get(1) or av.NONE)
    return av.element(owner, key)


def _has_key(_: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    name = owner.key_of(arguments.value(0))
    if name is av.OPEN:
        return av.Unknown("has_key")
    found = name in owner.entries
    return av.Scalar(found) if found or not owner.open else av.Unknown("has_key")


def _count(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    found = _has_key(machine, owner, arguments)
    return av.Scalar(int(found.value)) if isinstance(found, av.Scalar) else found


def _insert_pair(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    """`insert(pair)`, `emplace(key, args…)`, `insert({{key, value}, …})`: what is there stays."""
    items, _ = av.items_of(arguments.value(0))
    if len(arguments.values) > 1:
        return _emplace_entry(machine, owner, arguments)
    if items and all(isinstance(item, av.ListValue) for item in items):
        for item in items:
            _insert_pair(machine, owner, arguments.with_values(item))
        return av.NONE
    return _emplace_entry(machine, owner, arguments.with_values(*items[:1], *items[1:2]))


def _emplace_entry(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    if isinstance(arguments.value(0), av.ExternalSymbol):
        parts = [av.items_of(value)[0] for value in arguments.values[1:]]
        arguments = arguments.with_values(*(item for part in parts for item in part))
    key, rest = arguments.value(0), arguments.without_first(1)
    is_new = owner.key_of(key) not in owner.entries
    if is_new:
        _set(machine, owner, key, rest)
    entry = av.element(owner, key)
    return av.pair_of(av.pair_of(key, entry), av.Scalar(is_new))


def _assign(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    _set(machine, owner, arguments.value(0), arguments.without_first(1))
    return av.NONE


def _set(machine: AbstractMachine, owner: av.MapValue, key: av.Value, rest: Arguments) -> None:
    if rest.values or owner.default_factory is None:
        value = make_item(machine, owner, rest) if rest.values else av.UNKNOWN
    else:
        value = owner.default_factory()
    machine.undo_log.set(owner.fields, owner.key_of(key), value)


def _find_pair(machine: AbstractMachine, owner: av.MapValue, arguments: Arguments) -> av.Value:
    key = arguments.get(0)
    found = _has_key(machine, owner, arguments)
    if not (isinstance(found, av.Scalar) and isinstance(key, av.Scalar)):
        return av.Unknown("find")
    if not found.value:
        return end(machine, owner, arguments)
    position = list(owner.entries).index(key.value)
    return iterator_to(machine, owner, position, arguments)


DICT_METHODS: containers.LibraryMethods = {
    "get": _get,
    **dict.fromkeys(("keys", "iterkeys"), _keys),
    **dict.fromkeys(("values", "itervalues"), _values),
    **dict.fromkeys(("items", "iteritems"), _items),
    "update": _update,
    "setdefault": _set_default,
    **dict.fromkeys(("has_key", "__contains__"), _has_key),
    "pop": _pop_entry,
    "clear": _clear_map,
    "copy": lambda _, owner, ___: av.MapValue(
        dict(owner.fields), owner.iterates_pairs, owner.default_factory
    ),
}
CPP_MAP_METHODS: containers.LibraryMethods = {
    "at": _get,
    "count": _count,
    **dict.fromkeys(("contains", "hasMember"), _has_key),
    **dict.fromkeys(("insert", "emplace", "try_emplace"), _insert_pair),
    "insert_or_assign": _assign,
    "find": _find_pair,
    "size": containers.size,
    "empty": containers.is_empty,
    "erase": _pop_entry,
    "clear": _clear_map,
}


def cpp_container_member(owner: av.ListValue | av.MapValue, name: str) -> av.Value | None:
    """Return a method of a container of C++, bound to it."""
    walk = {"begin": begin, "end": end, "cbegin": begin, "cend": end}.get(name)
    if walk is not None:
        return av.LibraryFunction(name, walk, owner)
    methods = containers.LIST_METHODS if isinstance(owner, av.ListValue) else CPP_MAP_METHODS
    return containers.bound_method(methods, owner, name)
