"""Methods of lists and of the sequences of C++."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    UNKNOWN,
    ClassValue,
    Instance,
    LibraryFunction,
    ListValue,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.cpp.braces import default_item, is_braces, make_item
from rtron.sources.code.interpreter.cpp.iterators import ITERATOR, is_end, items_after
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
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


def _clear(machine: AbstractMachine, owner: ListValue, _: Arguments) -> Value:
    return _write(machine, owner, ())


def size(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    """`size()` of any container."""
    items, certain = items_of(owner)
    return Scalar(len(items)) if certain else Unknown("size")


def is_empty(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    """`empty()` of any container."""
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
    "size": size,
    "empty": is_empty,
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


def bound_method(methods: LibraryMethods, owner: Value, name: str) -> Value | None:
    """Return a method of a container, bound to it."""
    call = methods.get(name)
    return LibraryFunction(name, call, owner) if call is not None else None
