"""Messages of rclpy's classes with values dense at the bounds, and their bytes as they travel."""

import array
from importlib import import_module

from rclpy.serialization import serialize_message
from rosidl_parser.definition import (
    AbstractString,
    AbstractWString,
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    NamespacedType,
)

from rtron.errors import WireError
from rtron.messages.common.encoding import PADDING


def made(cls, pick):
    """Return a message whose values `pick` has chosen, each from a list."""
    message = cls()
    for name, kind in zip(cls.get_fields_and_field_types(), cls.SLOT_TYPES, strict=True):
        found = _value(kind, pick)
        before = getattr(message, name)
        if isinstance(before, array.array):
            found = array.array(before.typecode, found)
        setattr(message, name, found)
    return message


def round_trip(message, look):
    """Return a message's bytes up to its last field's last, as `look` finds it.

    `serialize_message` leaves more behind it than a publisher does: as many as Fast CDR has guessed
    that alignment takes.
    """
    data = serialize_message(message)
    whole = next(end for end in range(len(data), 0, -1) if _accepts(look, data[:end]))
    least = max(whole - PADDING, 0)
    return data[: next(end for end in range(least, whole + 1) if _accepts(look, data[:end]))]


def _accepts(look, data):
    try:
        look(data)
    except WireError:
        return False
    return True


def _value(kind, pick):
    if isinstance(kind, BasicType):
        return _basic(kind.typename, pick)
    if isinstance(kind, BoundedString):
        return pick(["", "a", "x" * kind.maximum_size])
    if isinstance(kind, AbstractString):
        return pick(["", "a", "map", "ä€😀", "x" * 200])
    if isinstance(kind, AbstractWString):
        return pick(["", "a", "ä€"])
    if isinstance(kind, NamespacedType):
        return made(getattr(import_module(".".join(kind.namespaces)), kind.name), pick)
    return [_value(kind.value_type, pick) for _ in range(_count(kind, pick))]


def _count(kind, pick):
    if isinstance(kind, Array):
        return kind.size
    if isinstance(kind, BoundedSequence):
        return pick([0, 1, kind.maximum_size])
    return pick([0, 1, 2, 3, 9])


def _basic(name, pick):
    if name == "boolean":
        return pick([False, True])
    if name == "octet":
        return pick([b"\0", b"\1", b"\xff"])
    if name in ("float", "double"):
        return pick([0.0, -1.5, float("inf")])
    bits, signed = int(name.lstrip("uint")), name[0] != "u"
    low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) if signed else (0, 2**bits - 1)
    return pick([low, low + 1, 1, high - 1, high])
