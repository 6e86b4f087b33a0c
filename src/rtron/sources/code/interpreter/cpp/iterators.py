"""Iterators of C++ containers: `for (it = xs.begin(); it != xs.end(); ++it)`."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    Hole,
    Instance,
    Known,
    ListValue,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_END, _OWNER = "end", "owner"


def begin(_: Machine, owner: Value, __: Arguments) -> Value:
    """`container.begin()`."""
    items, certain = items_of(owner)
    holder = Instance(NativeClass("items"), {**dict(enumerate(items)), _OWNER: owner})
    return _at(holder, 0, len(items), certain=certain)


def items_from(value: Value | None) -> tuple[list[tuple[Instance, Value]], bool] | None:
    """Return the places from an iterator on with what is there, and whether these are all."""
    if not isinstance(value, Instance) or value.type is not ITERATOR or _END in value.fields:
        return None
    items, place, count = (value.fields[name] for name in ("items", "at", "count"))
    if not (isinstance(items, Instance) and isinstance(place, Known) and isinstance(count, Known)):
        return None
    certain = value.fields["certain"] == Known(value=True)
    places = range(place.value, count.value)
    found = [_at(items, at, count.value, certain=certain) for at in places]
    return [(one, item_at(one)) for one in found], certain


def written(machine: Machine, held: Value | None, value: Value) -> bool:
    """Do `*it = value`: a variable that holds an iterator can get nothing but iterators itself."""
    if not isinstance(held, Instance) or held.type is not ITERATOR or _END in held.fields:
        return False
    if isinstance(value, (Hole, Choice)) or getattr(value, "type", None) is ITERATOR:
        return False
    items, place = held.fields["items"], held.fields["at"]
    if isinstance(items, Instance) and isinstance(place, Known):
        machine.trail.set(items.fields, place.value, value)
        owner = items.fields[_OWNER]
        if isinstance(owner, ListValue) and place.value < len(owner.items):
            changed = (*owner.items[: place.value], value, *owner.items[place.value + 1 :])
            machine.trail.set(owner.fields, "items", changed)
    return True


def end(_: Machine, __: Value, ___: Arguments) -> Value:
    """`container.end()`."""
    return Instance(ITERATOR, {_END: Known(value=True)})


def item_at(value: Value) -> Value:
    """Return what an iterator points at; any other value is itself."""
    if not isinstance(value, Instance) or value.type is not ITERATOR or _END in value.fields:
        return value
    items = value.fields["items"]
    place = value.fields["at"]
    found = (
        items.fields.get(place.value)
        if isinstance(items, Instance) and isinstance(place, Known)
        else None
    )
    return found or Hole("item")


def _at(items: Instance, place: int, count: int, *, certain: bool) -> Instance:
    return Instance(
        ITERATOR,
        {"items": items, "at": Known(place), "count": Known(count), "certain": Known(certain)},
    )


def _next(_: Machine, owner: Instance, __: Arguments) -> Value:
    items, place, count = (owner.fields.get(name) for name in ("items", "at", "count"))
    if not (isinstance(items, Instance) and isinstance(place, Known) and isinstance(count, Known)):
        return Hole("iterator")
    certain = owner.fields["certain"] == Known(value=True)
    return _at(items, place.value + 1, count.value, certain=certain)


def _differs(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    other = arguments.get(0)
    is_end = isinstance(other, Instance) and _END in other.fields
    if is_end and _END in owner.fields:
        return Known(value=False)
    if not is_end or _END in owner.fields:
        return Hole("iterator")
    place, count = owner.fields["at"], owner.fields["count"]
    inside = isinstance(place, Known) and isinstance(count, Known) and place.value < count.value
    if inside or owner.fields["certain"] == Known(value=True):
        return Known(inside)
    return Hole("iterator")


def _equals(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    answer = _differs(machine, owner, arguments)
    return Known(not answer.value) if isinstance(answer, Known) else answer


ITERATOR = NativeClass(
    "iterator",
    methods={
        "operator+": _next,
        "operator!=": _differs,
        "operator==": _equals,
        "operator<": _differs,
    },
)
