"""Velocities in messages: read, and written back into a copy with all else as it was."""

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rtron.messages.common.definition import Definition
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.common.layout import (
    MessageLayout,
    align_to,
    alignment,
    message_reader,
    skip_field,
    zero_body_size,
)
from rtron.vocabulary import TWIST_COMPONENTS, Velocity

_LARGEST: float = struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]
_SINGLE, _BITS = struct.Struct("<f"), struct.Struct("<I")
_NAN = float("nan")


@dataclass(frozen=True, slots=True, kw_only=True)
class _VelocityShape:
    """What a type must look like: the floats that it has, itself or in its field `field`.

    The first `linear` floats from `first_float` on are the linear part, the next `angular` floats
    the angular part.
    """

    floats: tuple[str, ...]
    field: str = ""
    first_float: int = 0
    linear: int = 1
    angular: int = 0
    is_limit: bool = False


_TWIST = TWIST_COMPONENTS
_DRIVE = ("steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk")
_LIMIT = _VelocityShape(floats=("data",), is_limit=True)
_SHAPES = {
    "geometry_msgs/Twist": _VelocityShape(floats=_TWIST, linear=3, angular=3),
    "geometry_msgs/TwistStamped": _VelocityShape(floats=_TWIST, field="twist", linear=3, angular=3),
    "ackermann_msgs/AckermannDrive": _VelocityShape(floats=_DRIVE, first_float=2),
    "ackermann_msgs/AckermannDriveStamped": _VelocityShape(
        floats=_DRIVE, field="drive", first_float=2
    ),
    "std_msgs/Float64": _LIMIT,
    "std_msgs/Float32": _LIMIT,
}
VELOCITY_TYPES = frozenset(_SHAPES)
"""The message types that a velocity can be read from, in ROS 1 spelling."""
MOTION_TYPES = frozenset(type for type, shape in _SHAPES.items() if not shape.is_limit)
"""Those of them that a robot drives at: the guard can make it stop with them."""

_FindFloats = Callable[[bytes], int]


class VelocityCodec:
    """Reads the velocity of messages of one type, and writes another into a copy of one."""

    __slots__ = (
        "_angular",
        "_find",
        "_has_only_velocity",
        "_linear",
        "_pack",
        "_span",
        "_unpack",
        "is_limit",
        "zero_message",
    )

    def __init__(self, shape: _VelocityShape, code: str, find: _FindFloats, rest: bytes) -> None:
        count = shape.linear + shape.angular
        size = struct.calcsize(code)
        end = shape.first_float + shape.linear
        self.is_limit = shape.is_limit
        """Whether the messages tell a maximal velocity, not one to drive at."""
        self.zero_message = rest
        """A message without a name or a time in it that asks for velocity 0."""
        self._find = find
        self._unpack = struct.Struct(f"<{len(shape.floats)}{code}").unpack_from
        self._pack = struct.Struct(f"<{count}{code}").pack if code == "d" else _pack_singles
        self._linear = slice(shape.first_float, end)
        self._angular = slice(end, end + shape.angular)
        self._span = (shape.first_float * size, (shape.first_float + count) * size)
        self._has_only_velocity = count == len(shape.floats)

    def decode(self, message: bytes) -> Velocity:
        """Return the velocity; WireError if the message is malformed.

        Where another of its floats, a steering angle for instance, is no number, neither is this.
        """
        values = self._unpack(message, self._find(message))
        if self._has_only_velocity or all(map(math.isfinite, values)):
            return Velocity(values[self._linear], values[self._angular])
        return Velocity((_NAN,))

    def is_finite(self, message: bytes) -> bool:
        """Return whether all floats are numbers, as `decode` finds; WireError if it is malformed.

        The sum is the quick answer: it is no number if one of them is none, or if they are huge.
        """
        values = self._unpack(message, self._find(message))
        return math.isfinite(sum(values)) or all(map(math.isfinite, values))

    def encode(self, message: bytes, velocity: Velocity) -> bytes:
        """Return a copy of the message with this velocity; WireError as in `decode`.

        Rounding to 32 bits goes toward 0.
        """
        at = self._find(message)
        start, end = self._span
        packed = self._pack(*velocity.linear, *velocity.angular)
        return message[: at + start] + packed + message[at + end :]


def velocity_codec(definition: Definition, encoding: Encoding) -> VelocityCodec | None:
    """Return the codec for a type; None if it is no velocity, or not defined as ROS defines it."""
    shape = _SHAPES.get(definition.type)
    if shape is None:
        return None
    code = _float_code(shape, definition)
    if code is None:
        return None
    size = struct.calcsize(code) * len(shape.floats)
    find = (
        _field_start(definition, encoding, shape) if shape.field else _fixed_start(encoding, size)
    )
    length = zero_body_size(definition, encoding)
    if length is None:
        return None
    return VelocityCodec(shape, code, find, encoding.prefix(length) + bytes(length))


def _float_code(shape: _VelocityShape, definition: Definition) -> str | None:
    """Return how `struct` calls the one type of all the floats."""
    owner: Definition | None = definition
    if shape.field:
        field = definition.find(shape.field)
        owner = definition.nested.get(field.type) if field and not field.array else None
    leaves = _leaves(owner) if owner else None
    if leaves is None or tuple(name for name, _ in leaves) != shape.floats:
        return None
    types = {type for _, type in leaves}
    return {"float32": "f", "float64": "d"}.get(types.pop()) if len(types) == 1 else None


def _leaves(definition: Definition) -> list[tuple[str, str]] | None:
    """Return the names and types of all the values of a message; None if it has arrays."""
    found: list[tuple[str, str]] = []
    for field in definition.fields:
        if field.array:
            return None
        nested = definition.nested.get(field.type)
        inner = _leaves(nested) if nested else [("", field.type)]
        if inner is None:
            return None
        found += [(f"{field.name}.{name}".rstrip("."), type) for name, type in inner]
    return found


def _fixed_start(encoding: Encoding, size: int) -> _FindFloats:
    """Return what checks a message of nothing but `size` bytes of floats."""
    length = PREFIX + size
    usual = encoding.prefix(size)

    def find(message: bytes) -> int:
        if len(message) != length or message[:PREFIX] != usual:
            encoding.check_prefix(message)
            encoding.check_end(length, message)
        return PREFIX

    return find


def _field_start(definition: Definition, encoding: Encoding, shape: _VelocityShape) -> _FindFloats:
    """Return what goes over a message and tells where its field `field` begins."""
    layout = MessageLayout(encoding)
    for field in definition.fields:
        if field.name == shape.field:
            layout.step(_mark(_first_alignment(definition.nested[field.type], encoding)))
        skip_field(layout, field, definition)
    read = message_reader(layout.steps(), encoding)

    def find(message: bytes) -> int:
        at: int = read(message)[0]
        return at

    return find


def _first_alignment(definition: Definition, encoding: Encoding) -> int:
    leaves = _leaves(definition) or [("", "")]
    return alignment(leaves[0][1], encoding)


def _mark(align: int) -> Callable[[bytes, int, list[Any]], int]:
    def mark(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        out.append(align_to(align, at))
        return at

    return mark


def _pack_singles(*values: float) -> bytes:
    return b"".join(map(_toward_zero, values))


def _toward_zero(value: float) -> bytes:
    """Return the float32 nearest to `value` of those that are not farther from 0."""
    if math.isfinite(value):
        value = min(max(value, -_LARGEST), _LARGEST)
    packed = _SINGLE.pack(value)
    if abs(_SINGLE.unpack(packed)[0]) > abs(value):
        return _BITS.pack(_BITS.unpack(packed)[0] - 1)
    return packed
