"""What a loop over a value sees."""

from collections.abc import Iterable, Iterator

from rtron.sources.code.interpreter.abstract_values.value_types import (
    IDENTIFIED,
    UNKNOWN,
    Choice,
    ClassValue,
    ExternalSymbol,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    is_tainted,
    options,
)

_MAX_DEPTH = 4

PAIR = LibraryClass("std::pair")


def items_of(value: Value) -> tuple[tuple[Value, ...], bool]:
    """Return the items of a value, and whether these are all."""
    if isinstance(value, Choice):
        found = [items_of(option)[0] for option in options(value)]
        return tuple(item for items in found for item in items), False
    if isinstance(value, ListValue):
        return value.items, not value.open
    if isinstance(value, MapValue):
        return _map_items(value), not value.open
    if isinstance(value, Instance):
        return _instance_items(value)
    if isinstance(value, ClassValue):
        return tuple(_members(value)), True
    return _scalar_items(value)


def is_record(type: object) -> bool:
    """Tell whether a class is a namedtuple, whose objects have their items for fields."""
    return isinstance(type, LibraryClass) and "_asdict" in type.methods


def pair_of(first: Value, second: Value) -> Instance:
    """Return a std::pair."""
    return Instance(PAIR, {"first": first, "second": second})


def list_of(items: Iterable[Value], kind: str = "list", *, certain: bool = True) -> ListValue:
    """Return a list of these items; unless that is certain, it may hold others as well."""
    return ListValue({"items": tuple(items), "open": not certain}, kind)


def unpack(value: Value, count: int) -> tuple[Value, ...]:
    """Return a value taken apart into `count` variables."""
    items, certain = items_of(value)
    if isinstance(value, Instance) and isinstance(value.type, ClassValue):
        members = [one.name for one in value.type.definition.fields]
        items = tuple(value.fields[name] for name in members if name in value.fields)
        certain = True
    if certain and len(items) == count:
        return items
    return tuple(Unknown(getattr(value, "label", "?")) for _ in range(count))


def _instance_items(value: Instance) -> tuple[tuple[Value, ...], bool]:
    if value.type is PAIR:
        return (value.fields["first"], value.fields["second"]), True
    if is_record(value.type):
        return tuple(value.fields.values()), True
    return (), False


def _scalar_items(value: Value) -> tuple[tuple[Value, ...], bool]:
    """Return the letters of a text; None has no items, of others they are not known."""
    if isinstance(value, Scalar) and isinstance(value.value, str):
        return tuple(Scalar(letter, value.tainted) for letter in value.value), True
    return (), value == Scalar(None)


def _map_items(value: MapValue) -> tuple[Value, ...]:
    if value.iterates_pairs:
        return tuple(pair_of(_key(key, entry), entry) for key, entry in value.entries.items())
    return tuple(_key(key, entry) for key, entry in value.entries.items())


def _key(key: object, entry: Value) -> Value:
    """Return a map's key, marked as its entry is: both came out of the parameter server."""
    return key_value(key, tainted=_holds_parameter(entry))


def key_value(key: object, *, tainted: bool = False) -> Value:
    """Return the value that a key of a dict stands for."""
    if isinstance(key, tuple):
        items = tuple(key_value(item, tainted=tainted) for item in key)
        return list_of(items, "tuple")
    return key if isinstance(key, (*IDENTIFIED, ExternalSymbol)) else Scalar(key, tainted)


def _holds_parameter(value: Value, depth: int = _MAX_DEPTH) -> bool:
    """Tell whether anything in a value, which may hold itself, is a parameter's."""
    if isinstance(value, MapValue):
        inner = tuple(value.entries.values())
    elif isinstance(value, ListValue):
        inner = value.items
    else:
        return is_tainted(value)
    return depth > 0 and any(_holds_parameter(item, depth - 1) for item in inner)


def _members(cls: ClassValue) -> Iterator[Value]:
    """Yield the members of an enumeration."""
    for value in cls.fields.values():
        if isinstance(value, Instance) and value.type is cls:
            yield value


def unpack_with_rest(value: Value, before: int, after: int) -> tuple[Value, ...]:
    """Return a value taken apart into `before` variables, a list of the rest, and `after` more."""
    items, certain = items_of(value)
    if not certain or len(items) < before + after:
        rest = list_of((), certain=False)
        return (*(UNKNOWN for _ in range(before)), rest, *(UNKNOWN for _ in range(after)))
    end = len(items) - after
    return (*items[:before], list_of(items[before:end]), *items[end:])
