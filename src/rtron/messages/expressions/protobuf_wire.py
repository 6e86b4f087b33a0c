"""A ROS message as a protobuf message on the wire, which is how its fields come into expressions.

Only types of fixed size are used for numbers, so most values are copied as the bytes that they are
(protobuf.dev: Encoding). Fields are numbered from 1 in their order. All integers become int64
values of the expression language, times seconds, uint8[] and char[] bytes.
"""

import struct
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import (
    Convert,
    MessageLayout,
    Step,
    align_to,
    alignment,
    count_reader,
    each_element,
    lay_out_empty_message,
    message_reader,
    skip_field,
)

DELIMITED = 2
"""The wire type of what has its length in front."""
_NANO = 1e-9
_VARINT_BITS = 7
_VARINT_MORE = 0x80


@dataclass(frozen=True, slots=True)
class Kind:
    """How a primitive value is written: protobuf's type, its wire type and size."""

    type: str
    wire: int
    size: int


_DOUBLE = Kind("TYPE_DOUBLE", 1, 8)
_FLOAT = Kind("TYPE_FLOAT", 5, 4)
_INT32 = Kind("TYPE_SFIXED32", 5, 4)
_INT64 = Kind("TYPE_SFIXED64", 1, 8)
_BOOL = Kind("TYPE_BOOL", 0, 1)

KINDS = {
    "bool": _BOOL,
    "byte": _INT32,
    "char": _INT32,
    "int8": _INT32,
    "uint8": _INT32,
    "int16": _INT32,
    "uint16": _INT32,
    "int32": _INT32,
    "uint32": _INT64,
    "int64": _INT64,
    "uint64": _INT64,
    "float32": _FLOAT,
    "float64": _DOUBLE,
    "time": _DOUBLE,
    "duration": _DOUBLE,
}


def is_bytes(field: Field) -> bool:
    """Tell whether a field is written as one value of bytes."""
    return field.array and field.type in ("uint8", "char")


def transcoder(
    definition: Definition, encoding: Encoding, selected: Collection[str]
) -> Callable[[bytes], bytes]:
    """Return what writes the `selected` fields of a message; WireError if it is malformed."""
    layout = MessageLayout(encoding)
    lay_out_empty_message(layout, definition)
    for number, field in enumerate(definition.fields, 1):
        if field.name in selected:
            _copy_field(layout, field, number, definition)
        else:
            skip_field(layout, field, definition)
    read = message_reader(layout.steps(), encoding)
    return lambda message: b"".join(read(message))


def _copy_field(layout: MessageLayout, field: Field, number: int, definition: Definition) -> None:
    if not field.array:
        _copy_single(layout, field, number, definition)
    elif field.type in KINDS:
        _copy_values(layout, field, number)
    else:
        layout.step(
            each_element(
                layout,
                field,
                definition,
                lambda inner, single, owner: _copy_single(inner, single, number, owner),
            )
        )


def _copy_single(layout: MessageLayout, field: Field, number: int, definition: Definition) -> None:
    encoding = layout.encoding
    if nested := definition.nested.get(field.type):
        _copy_message(layout, nested, number)
    elif field.type == "string":
        layout.step(_copy_string(encoding, _tag(number, DELIMITED)))
    else:
        kind = KINDS[field.type]
        layout.literal(_tag(number, kind.wire))
        convert = _convert(field.type, encoding)
        layout.value(SIZES[field.type], alignment(field.type, encoding), convert)


def _copy_message(layout: MessageLayout, definition: Definition, number: int) -> None:
    tag = _tag(number, DELIMITED)
    size = _written_size(definition)
    if size is None:
        inner = MessageLayout(layout.encoding, known=1)
        _copy_fields(inner, definition)
        layout.step(_copy_delimited(inner.steps(), tag))
    else:
        layout.literal(tag + varint(size))
        _copy_fields(layout, definition)


def _copy_fields(layout: MessageLayout, definition: Definition) -> None:
    lay_out_empty_message(layout, definition)
    for number, field in enumerate(definition.fields, 1):
        _copy_field(layout, field, number, definition)


def _written_size(definition: Definition) -> int | None:
    """Return how many bytes a message is written in, None if that differs from one to another."""
    total = 0
    for number, field in enumerate(definition.fields, 1):
        size = _written_field(field, definition)
        if size is None:
            return None
        total += len(_tag(number, 0)) + size
    return total


def _written_field(field: Field, definition: Definition) -> int | None:
    nested = definition.nested.get(field.type)
    if field.type == "string" or (field.array and (nested or field.length is None)):
        return None
    size = _written_size(nested) if nested else KINDS[field.type].size
    if size is None:
        return None
    if field.array:
        size = _array_size(field, field.length or 0)
    return size + len(varint(size)) if nested or field.array else size


def _array_size(field: Field, count: int) -> int:
    return count * (1 if is_bytes(field) else KINDS[field.type].size)


def _copy_values(layout: MessageLayout, field: Field, number: int) -> None:
    """Lay out an array of primitive values: one block of bytes on either side."""
    tag = _tag(number, DELIMITED)
    size, align = SIZES[field.type], alignment(field.type, layout.encoding)
    convert = None if is_bytes(field) else _convert(field.type, layout.encoding)
    if field.length is None:
        layout.step(_copy_block(layout.encoding, size, align, tag, convert))
    else:
        layout.literal(tag + varint(_array_size(field, field.length)))
        layout.value(field.length * size, align, convert)


def _copy_block(
    encoding: Encoding, size: int, align: int, tag: bytes, convert: Convert | None
) -> Step:
    count_of = count_reader(encoding, size)

    def copy(data: bytes, at: int, out: list[Any]) -> int:
        count, at = count_of(data, at)
        if not count:
            return at
        at = align_to(align, at)
        end = at + count * size
        block = data[at:end]
        out.append(_delimited(tag, convert(block) if convert else block))
        return end

    return copy


def _copy_string(encoding: Encoding, tag: bytes) -> Step:
    count_of = count_reader(encoding, 1)
    terminated = encoding is Encoding.CDR

    def copy(data: bytes, at: int, out: list[Any]) -> int:
        count, at = count_of(data, at)
        end = at + count
        text = data[at:end]
        if terminated and count:
            text = _without_nul(text)
        _check_utf8(text)
        out.append(_delimited(tag, text))
        return end

    return copy


def _without_nul(text: bytes) -> bytes:
    if text[-1]:
        raise WireError("a string does not end with a NUL")
    return text[:-1]


def _check_utf8(text: bytes) -> None:
    if not text.isascii():
        try:
            text.decode()
        except UnicodeDecodeError as error:
            raise WireError(f"a string is not UTF-8: {error.reason}") from error


def _copy_delimited(steps: tuple[Step, ...], tag: bytes) -> Step:
    def copy(data: bytes, at: int, out: list[Any]) -> int:
        inner: list[Any] = []
        for step in steps:
            at = step(data, at, inner)
        out.append(_delimited(tag, b"".join(inner)))
        return at

    return copy


def _delimited(tag: bytes, content: bytes) -> bytes:
    return b"%b%b%b" % (tag, varint(len(content)), content)


def varint(number: int) -> bytes:
    """Return a number, not negative, in protobuf's variable length."""
    found = bytearray()
    while number >= _VARINT_MORE:
        found.append(number & (_VARINT_MORE - 1) | _VARINT_MORE)
        number >>= _VARINT_BITS
    found.append(number)
    return bytes(found)


def _tag(number: int, wire: int) -> bytes:
    return varint(number << 3 | wire)


def _convert(type: str, encoding: Encoding) -> Convert | None:
    """Return what widens the bytes of any number of values, None if they stay as they are."""
    ros1 = encoding is Encoding.ROS1
    if type == "bool":
        return _bools
    if type in ("time", "duration"):
        return _seconds(("II" if type == "time" else "ii") if ros1 else "iI")
    if type == "byte":
        return _widened("b" if ros1 else "B", "i")
    codes = _WIDER.get(type)
    return _widened(*codes) if codes else None


_WIDER = {
    "char": ("B", "i"),
    "int8": ("b", "i"),
    "uint8": ("B", "i"),
    "int16": ("h", "i"),
    "uint16": ("H", "i"),
    "uint32": ("I", "q"),
    "uint64": ("Q", "q"),
}
_TRUTH = b"\x00" + b"\x01" * 255


def _bools(block: bytes) -> bytes:
    return block.translate(_TRUTH)


def _widened(source: str, target: str) -> Convert:
    size = struct.calcsize(source)

    def widen(block: bytes) -> bytes:
        count = len(block) // size
        values = struct.unpack(f"<{count}{source}", block)
        try:
            return struct.pack(f"<{count}{target}", *values)
        except struct.error as error:
            raise WireError("an integer is above 2^63 - 1") from error

    return widen


def _seconds(code: str) -> Convert:
    stamp = struct.Struct("<" + code)

    def convert(block: bytes) -> bytes:
        found = [seconds + nano * _NANO for seconds, nano in stamp.iter_unpack(block)]
        return struct.pack(f"<{len(found)}d", *found)

    return convert
