"""Iterators of C++ containers: `for (it = xs.begin(); it != xs.end(); ++it)`."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    Instance,
    LibraryClass,
    ListValue,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_END, _CONTAINER = "end", "owner"


def begin(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    """`container.begin()`."""
    items, certain = items_of(owner)
    holder = Instance(LibraryClass("items"), {**dict(enumerate(items)), _CONTAINER: owner})
    return _iterator_at(holder, 0, len(items), certain=certain)


def iterator_to(machine: AbstractMachine, owner: Value, position: int, at: Arguments) -> Value:
    """Return an iterator at one of a container's items."""
    first = begin(machine, owner, at)
    found = items_after(first)
    return found[0][position][0] if found is not None and position < len(found[0]) else first


def items_after(value: Value | None) -> tuple[list[tuple[Instance, Value]], bool] | None:
    """Return the iterators from one on with their items, and whether these are all."""
    if not isinstance(value, Instance) or value.type is not ITERATOR or _END in value.fields:
        return None
    items, position, count = (value.fields[name] for name in ("items", "at", "count"))
    if not (
        isinstance(items, Instance) and isinstance(position, Scalar) and isinstance(count, Scalar)
    ):
        return None
    certain = value.fields["certain"] == Scalar(value=True)
    positions = range(position.value, count.value)
    found = [_iterator_at(items, at, count.value, certain=certain) for at in positions]
    return [(one, dereference(one)) for one in found], certain


def write_through(machine: AbstractMachine, held: Value | None, value: Value) -> bool:
    """Do `*it = value`: a variable that holds an iterator can get nothing but iterators itself."""
    if not isinstance(held, Instance) or held.type is not ITERATOR or _END in held.fields:
        return False
    if isinstance(value, (Unknown, Choice)) or getattr(value, "type", None) is ITERATOR:
        return False
    items, position = held.fields["items"], held.fields["at"]
    if isinstance(items, Instance) and isinstance(position, Scalar):
        machine.undo_log.set(items.fields, position.value, value)
        owner = items.fields[_CONTAINER]
        if isinstance(owner, ListValue) and position.value < len(owner.items):
            changed = (*owner.items[: position.value], value, *owner.items[position.value + 1 :])
            machine.undo_log.set(owner.fields, "items", changed)
    return True


def end(_: AbstractMachine, __: Value, ___: Arguments) -> Value:
    """`container.end()`."""
    return Instance(ITERATOR, {_END: Scalar(value=True)})


def container_of(value: Value | None) -> Value | None:
    """Return what an iterator goes through, any other value as it is."""
    if not isinstance(value, Instance) or value.type is not ITERATOR or _END in value.fields:
        return value
    items = value.fields["items"]
    return items.fields[_CONTAINER] if isinstance(items, Instance) else value


def position_of(value: Value | None) -> int:
    """Return how many items stand before an iterator; none where that is not known."""
    position = value.fields.get("at") if isinstance(value, Instance) else None
    return position.value if isinstance(position, Scalar) else 0


def is_end(value: Value) -> bool:
    """Tell whether a value is what `container.end()` gives."""
    return isinstance(value, Instance) and value.type is ITERATOR and _END in value.fields


def dereference(value: Value) -> Value:
    """Return what an iterator points at; any other value is itself."""
    if not isinstance(value, Instance) or value.type is not ITERATOR or _END in value.fields:
        return value
    items, position = value.fields["items"], value.fields["at"]
    if isinstance(items, Instance) and isinstance(position, Scalar):
        return items.fields.get(position.value) or Unknown("item")
    return Unknown("item")


def _iterator_at(items: Instance, position: int, count: int, *, certain: bool) -> Instance:
    return Instance(
        ITERATOR,
        {
            "items": items,
            "at": Scalar(position),
            "count": Scalar(count),
            "certain": Scalar(certain),
        },
    )


def _advance(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    items, position, count = (owner.fields.get(name) for name in ("items", "at", "count"))
    if not (
        isinstance(items, Instance) and isinstance(position, Scalar) and isinstance(count, Scalar)
    ):
        return Unknown("iterator")
    certain = owner.fields["certain"] == Scalar(value=True)
    return _iterator_at(items, position.value + 1, count.value, certain=certain)


def _not_equal(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    other = arguments.get(0)
    is_end = isinstance(other, Instance) and _END in other.fields
    if is_end and _END in owner.fields:
        return Scalar(value=False)
    if not is_end or _END in owner.fields:
        return Unknown("iterator")
    position, count = owner.fields["at"], owner.fields["count"]
    inside = (
        isinstance(position, Scalar) and isinstance(count, Scalar) and position.value < count.value
    )
    if inside or owner.fields["certain"] == Scalar(value=True):
        return Scalar(inside)
    return Unknown("iterator")


def _equal(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    answer = _not_equal(machine, owner, arguments)
    return Scalar(not answer.value) if isinstance(answer, Scalar) else answer


ITERATOR = LibraryClass(
    "iterator",
    methods={
        "operator+": _advance,
        "operator!=": _not_equal,
        "operator==": _equal,
        "operator<": _not_equal,
    },
)
