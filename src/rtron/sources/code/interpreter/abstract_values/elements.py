"""Elements of what may be known in part: `owner[key]`."""

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    ClassValue,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    join,
    text_with_holes,
)

SLICE = LibraryClass("slice")


def element(owner: Value, key: Value) -> Value:
    """Return an element or slice, or an Unknown with the names of the owner and the key.

    An object that is an index is a member of an enumeration of numbers.
    """
    if is_slice(key):
        return _slice_value(owner, key)
    key = _number_of(owner, key)
    if isinstance(owner, MapValue):
        return _map_entry(owner, key)
    if isinstance(owner, ClassValue) and isinstance(key, Scalar):
        return owner.fields.get(key.value, Unknown(str(key.value)))
    if isinstance(key, Scalar) and isinstance(key.value, int):
        items, certain = items_of(owner)
        if -len(items) <= key.value < len(items) and (certain or key.value >= 0):
            return items[key.value]
    elif isinstance(owner, ListValue) and owner.items:
        return join(owner.items)
    return _unknown_element(owner, key)


def _number_of(owner: Value, key: Value) -> Value:
    is_member = isinstance(owner, ListValue) and isinstance(key, Instance)
    return key.fields.get("value", key) if is_member else key  # type: ignore[union-attr]


def _unknown_element(owner: Value, key: Value) -> Unknown:
    why = owner.label if isinstance(owner, Unknown) else ""
    shown = text_with_holes(key).strip("{}")
    below = is_tainted(owner) and isinstance(key, Scalar) and isinstance(key.value, str)
    return Unknown(f"{why}/{shown}" if below and why else f"{why}[{shown}]", is_tainted(owner))


def is_slice(key: Value) -> bool:
    """Tell whether a key is `i:j:k`."""
    return isinstance(key, Instance) and key.type is SLICE


def slice_of(key: Value) -> slice | None:
    """Return the slice that a key is; None if it is none, or its ends are not known."""
    if not isinstance(key, Instance) or key.type is not SLICE:
        return None
    bounds = [key.fields[name] for name in ("start", "stop", "step")]
    numbers = [bound.value for bound in bounds if isinstance(bound, Scalar)]
    known = len(numbers) == len(bounds) and numbers[2] != 0
    if not known or any(not isinstance(number, (int, type(None))) for number in numbers):
        return None
    return slice(*numbers)


def _slice_value(owner: Value, key: Value) -> Value:
    bounds = slice_of(key)
    if bounds is None:
        return Unknown("slice", is_tainted(owner))
    if isinstance(owner, ListValue):
        return list_of(owner.items[bounds], owner.kind, certain=not owner.open)
    if isinstance(owner, Scalar) and isinstance(owner.value, (str, bytes)):
        return Scalar(owner.value[bounds], owner.tainted)
    if isinstance(owner, PartialText):
        return _slice_text(owner, bounds.start, bounds.stop, bounds.step)
    return Unknown("slice", is_tainted(owner))


def _slice_text(owner: PartialText, start: int | None, stop: int | None, step: int | None) -> Value:
    """Cut off what is known at the ends of a string: `text[1:]`, `text[:-1]`."""
    first, last = owner.parts[0], owner.parts[-1]
    front, back = start or 0, -(stop or 0)
    cuts = 0 <= front <= _length(first) and 0 <= back <= _length(last)
    if not cuts or step not in {None, 1} or stop == 0 or len(owner.parts) == 1:
        return Unknown("slice", owner.tainted)
    parts = [*owner.parts]
    parts[0] = first[front:] if isinstance(first, str) else first
    parts[-1] = last[: len(last) - back] if isinstance(last, str) else last
    return concat(
        [part if isinstance(part, Unknown) else Scalar(part, owner.tainted) for part in parts]
    )


def _length(part: str | Unknown) -> int:
    return len(part) if isinstance(part, str) else 0


def _map_entry(owner: MapValue, key: Value) -> Value:
    name = owner.key_of(key)
    if name is OPEN:
        return join(owner.entries.values()) if owner.entries else Unknown(text_with_holes(key))
    label = str(key.value) if isinstance(key, Scalar) else text_with_holes(key)
    missing = owner.fields.get(OPEN, Unknown(label))
    return owner.fields.get(name, missing)
