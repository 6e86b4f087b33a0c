"""Methods of Python's lists and of C++'s sequences, which interpret alike."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.braces import default_item, is_braces, make_item
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR, is_end, items_after
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import remove_element
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import return_none

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


MAX_ITEMS = 1024
_FIRST = av.Scalar(0)
LibraryMethods = Mapping[str, Callable[..., av.Value]]


def _write(machine: AbstractMachine, owner: av.ListValue, items: tuple[av.Value, ...]) -> av.Value:
    machine.undo_log.set(owner.fields, "items", items[:MAX_ITEMS])
    if len(items) > MAX_ITEMS:
        machine.undo_log.mark_open(owner.fields)
    return av.NONE


def _append(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    item = arguments.get(0) or av.NONE
    return _write(machine, owner, (*owner.items, item))


def _push(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    """`push_back`: an object of a class is copied, as C++ does."""
    return _write(machine, owner, (*owner.items, _new_item(machine, owner, arguments)))


def _push_front(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    return _write(machine, owner, (_new_item(machine, owner, arguments), *owner.items))


def _emplace(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    """`emplace(args…)` of a set, `emplace(position, args…)` of a vector."""
    first = arguments.get(0)
    positioned = isinstance(first, av.Instance) and first.type is ITERATOR
    return _push(machine, owner, arguments.without_first(1) if positioned else arguments)


def _new_item(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    item = make_item(machine, owner, arguments)
    return item if id(item) in machine.pointer_held else copy_instance(item)


def copy_instance(value: av.Value) -> av.Value:
    """Return a C++ object of a scanned class as a new one, members and all."""
    if isinstance(value, av.Instance) and isinstance(value.type, av.ClassValue):
        return av.Instance(value.type, dict(value.fields), value.types, value.bindings)
    return value


def _extend(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    items, certain = av.items_of(arguments.value(0))
    if not certain:
        machine.undo_log.mark_open(owner.fields)
    return _write(machine, owner, (*owner.items, *items))


def _insert(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    index = arguments.get(0)
    if owner.type is not None:
        return _insert_cpp(machine, owner, arguments)
    if arguments.get(1) and isinstance(index, av.Scalar) and isinstance(index.value, int):
        before, after = owner.items[: index.value], owner.items[index.value :]
        return _write(machine, owner, (*before, arguments.get(1) or av.NONE, *after))
    return _write(machine, owner, (*owner.items, arguments.get(1) or arguments.get(0) or av.NONE))


def _insert_cpp(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    """`insert([position,] value)`, `insert([position,] first, last)`, of another container."""
    ranged = [items_after(value) for value in arguments.values[-2:-1]]
    if ranged and ranged[0] is not None and is_end(arguments.values[-1]):
        items, certain = ranged[0]
        if not certain:
            machine.undo_log.mark_open(owner.fields)
        return _write(machine, owner, (*owner.items, *(item for _, item in items)))
    last = arguments.without_first(len(arguments.values) - 1)
    return _write(machine, owner, (*owner.items, *_added(machine, owner, last)))


def _added(machine: AbstractMachine, owner: av.ListValue, last: Arguments) -> tuple[av.Value, ...]:
    """Return the items that the last argument of an insertion is; braces may hold several."""
    given = last.get(0)
    if isinstance(given, av.ListValue) and is_braces(given):
        return tuple(_new_item(machine, owner, last.with_values(item)) for item in given.items)
    return (_new_item(machine, owner, last),)


def _assign(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    """`assign(first, last)`, `assign({…})`, `assign(count, value)`."""
    count, given = arguments.get(0), arguments.get(1)
    _clear(machine, owner, arguments)
    if isinstance(count, av.Scalar) and isinstance(count.value, int):
        return _write(machine, owner, (given or av.UNKNOWN,) * max(0, min(count.value, MAX_ITEMS)))
    return _insert_cpp(machine, owner, arguments)


def _swap(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    other = arguments.get(0)
    if not isinstance(other, av.ListValue):
        machine.undo_log.mark_open(owner.fields)
        return av.NONE
    items, opened = owner.items, owner.open
    machine.undo_log.set(owner.fields, "open", other.open)
    machine.undo_log.set(other.fields, "open", opened)
    before = other.items
    _write(machine, other, items)
    return _write(machine, owner, before)


def _pop(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    first = owner.type is not None and owner.type.name == "std::queue"
    key = arguments.get(0) or av.Scalar(0 if first else -1)
    found = av.element(owner, key) if owner.items else av.Unknown("pop")
    remove_element(machine, owner, key)
    return found


def _remove_item(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    item = arguments.get(0)
    if item in owner.items and isinstance(item, av.Scalar):
        remove_element(machine, owner, av.Scalar(owner.items.index(item)))
    return av.NONE


def _clear(machine: AbstractMachine, owner: av.ListValue, _: Arguments) -> av.Value:
    return _write(machine, owner, ())


def size(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """`size()` of any container."""
    items, certain = av.items_of(owner)
    return av.Scalar(len(items)) if certain else av.Unknown("size")


def is_empty(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """`empty()` of any container."""
    filled = av.truth(owner)
    return av.Unknown("empty") if filled is None else av.Scalar(not filled)


def _resize(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    count, fill = arguments.get(0), arguments.get(1)
    if not (isinstance(count, av.Scalar) and isinstance(count.value, int)):
        machine.undo_log.mark_open(owner.fields)
        return av.NONE
    size = max(0, min(count.value, MAX_ITEMS + 1))
    more = size - len(owner.items)
    added = [fill or default_item(machine, owner, arguments.frame) for _ in range(more)]
    return _write(machine, owner, (*owner.items, *added)[:size])


def _sort(machine: AbstractMachine, owner: av.ListValue, arguments: Arguments) -> av.Value:
    machine.escape(arguments.get(0))
    if owner.open:
        machine.escape(arguments.keywords.get("key"))
    return _write(machine, owner, sort_items(machine, owner.items, arguments))


LIST_METHODS: LibraryMethods = {
    **dict.fromkeys(("append", "add"), _append),
    "appendleft": lambda machine, owner, arguments: _write(
        machine, owner, (arguments.get(0) or av.NONE, *owner.items)
    ),
    **dict.fromkeys(("push", "push_back", "emplace_back"), _push),
    **dict.fromkeys(("push_front", "emplace_front"), _push_front),
    "emplace": _emplace,
    **dict.fromkeys(("extend", "update"), _extend),
    "insert": _insert,
    "assign": _assign,
    "swap": _swap,
    **dict.fromkeys(("pop", "pop_back"), _pop),
    "clear": _clear,
    "size": size,
    "empty": is_empty,
    **dict.fromkeys(
        ("at", "front"), lambda _, owner, arguments: av.element(owner, arguments.get(0) or _FIRST)
    ),
    **dict.fromkeys(("back", "top"), lambda _, owner, __: av.element(owner, av.Scalar(-1))),
    "resize": _resize,
    **dict.fromkeys(
        ("copy", "data"), lambda _, owner, __: replace(owner, fields=dict(owner.fields))
    ),
    **dict.fromkeys(("remove", "discard"), _remove_item),
    "pop_front": lambda machine, owner, arguments: _pop(
        machine, owner, arguments.with_values(av.Scalar(0))
    ),
    "reserve": return_none,
    "reverse": lambda machine, owner, ___: _write(machine, owner, owner.items[::-1]),
    "sort": _sort,
}


def bound_method(methods: LibraryMethods, owner: av.Value, name: str) -> av.Value | None:
    """Return a method of a container, bound to it."""
    call = methods.get(name)
    return av.LibraryFunction(name, call, owner) if call is not None else None
