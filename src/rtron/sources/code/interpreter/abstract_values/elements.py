"""Elements of what may be known in part: `owner[key]`."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    NativeClass,
    Text,
    Value,
    concat,
    is_tainted,
    join,
    spelled,
)

SLICE = NativeClass("slice")


def element(owner: Value, key: Value) -> Value:
    """Return an element or slice, or a hole that is called after the owner and the key."""
    if is_slice(key):
        return _sliced(owner, key)
    if isinstance(owner, MapValue):
        return _entry(owner, key)
    if isinstance(owner, ClassValue) and isinstance(key, Known):
        return owner.fields.get(key.value, Hole(str(key.value)))
    if isinstance(key, Known) and isinstance(key.value, int):
        items, certain = items_of(owner)
        if -len(items) <= key.value < len(items) and (certain or key.value >= 0):
            return items[key.value]
    elif isinstance(owner, ListValue) and owner.items:
        return join(owner.items)
    return _unknown(owner, key)


def _unknown(owner: Value, key: Value) -> Hole:
    why = owner.why if isinstance(owner, Hole) else ""
    shown = spelled(key).strip("{}")
    below = is_tainted(owner) and isinstance(key, Known) and isinstance(key.value, str)
    return Hole(f"{why}/{shown}" if below and why else f"{why}[{shown}]", is_tainted(owner))


def is_slice(key: Value) -> bool:
    """Tell whether a key is `i:j:k`."""
    return isinstance(key, Instance) and key.type is SLICE


def slice_of(key: Value) -> slice | None:
    """Return the slice that a key is; None if it is none, or its ends are not known."""
    if not isinstance(key, Instance) or key.type is not SLICE:
        return None
    ends = [key.fields[name] for name in ("start", "stop", "step")]
    numbers = [end.value for end in ends if isinstance(end, Known)]
    known = len(numbers) == len(ends) and numbers[2] != 0
    if not known or any(not isinstance(number, (int, type(None))) for number in numbers):
        return None
    return slice(*numbers)


def _sliced(owner: Value, key: Value) -> Value:
    places = slice_of(key)
    if places is None:
        return Hole("slice", is_tainted(owner))
    if isinstance(owner, ListValue):
        return ListValue({"items": owner.items[places], "open": owner.open}, owner.kind)
    if isinstance(owner, Known) and isinstance(owner.value, (str, bytes)):
        return Known(owner.value[places], owner.tainted)
    return (
        _cut(owner, places.start, places.stop, places.step)
        if isinstance(owner, Text)
        else Hole("slice", is_tainted(owner))
    )


def _cut(owner: Text, start: int | None, stop: int | None, step: int | None) -> Value:
    """Cut off what is known at the ends of a string: `text[1:]`, `text[:-1]`."""
    first, last = owner.parts[0], owner.parts[-1]
    front, back = start or 0, -(stop or 0)
    cuts = 0 <= front <= _length(first) and 0 <= back <= _length(last)
    if not cuts or step not in {None, 1} or stop == 0 or len(owner.parts) == 1:
        return Hole("slice", owner.tainted)
    parts = [*owner.parts]
    parts[0] = first[front:] if isinstance(first, str) else first
    parts[-1] = last[: len(last) - back] if isinstance(last, str) else last
    return concat(
        [part if isinstance(part, Hole) else Known(part, owner.tainted) for part in parts]
    )


def _length(part: str | Hole) -> int:
    return len(part) if isinstance(part, str) else 0


def _entry(owner: MapValue, key: Value) -> Value:
    if not isinstance(key, Known):
        return join(owner.entries.values()) if owner.entries else Hole(spelled(key))
    missing = owner.fields.get(OPEN, Hole(str(key.value)))
    return owner.fields.get(key.value, missing)
