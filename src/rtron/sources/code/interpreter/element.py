"""Elements of what may be known in part: `owner[key]`."""

from rtron.sources.code.interpreter.items import items_of
from rtron.sources.code.interpreter.values import (
    OPEN,
    Hole,
    Known,
    ListValue,
    MapValue,
    Value,
    is_tainted,
    join,
    spelled,
)


def element(owner: Value, key: Value) -> Value:
    """Return an element, or a hole that is called after the key."""
    if isinstance(owner, MapValue):
        return _entry(owner, key)
    if isinstance(key, Known) and isinstance(key.value, int):
        items, certain = items_of(owner)
        if -len(items) <= key.value < len(items) and (certain or key.value >= 0):
            return items[key.value]
    elif isinstance(owner, ListValue) and owner.items:
        return join(owner.items)
    return Hole(f"[{spelled(key)}]", is_tainted(owner))


def _entry(owner: MapValue, key: Value) -> Value:
    if not isinstance(key, Known):
        return join(owner.entries.values()) if owner.entries else Hole(spelled(key))
    missing = owner.fields.get(OPEN, Hole(str(key.value)))
    return owner.fields.get(key.value, missing)
