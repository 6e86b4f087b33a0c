"""A message's bytes as JSON, as rosbridge writes it: base64 for bytes, null for NaN and Inf.

The bytes are a stranger's: a message that does not fit its definition is a WireError.
"""

import base64
import math
import struct
from dataclasses import dataclass
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.common.json_encoder import (
    BYTE_ARRAYS,
    CODES,
    TIME_FIELDS,
    primitive_code,
    time_code,
)
from rtron.messages.common.layout import align_to, alignment, min_size

_COUNT = struct.Struct("<I")


@dataclass(frozen=True, slots=True)
class NumberArray:
    """An array of numbers of a primitive type as they lie in a message, little-endian."""

    type: str
    data: bytes


def decode_json(definition: Definition, encoding: Encoding, message: bytes) -> dict[str, Any]:
    """Return a message as JSON values; WireError if it is malformed."""
    return _decode(_JsonReader(encoding, message), definition, message)


def decode_response(definition: Definition, encoding: Encoding, message: bytes) -> dict[str, Any]:
    """Return a response or a result as JSON values; WireError if it is malformed.

    In CDR it is what rclpy's `serialize_message` makes of it: that takes the size that its RMW has
    estimated, so bytes may follow the last field (seen with Fast DDS and empty arrays).
    """
    reader = _JsonReader(encoding, message)
    return _decode(reader, definition, message, is_exact=encoding is Encoding.ROS1)


def decode_binary(definition: Definition, encoding: Encoding, message: bytes) -> dict[str, Any]:
    """Return a message as values: arrays of numbers as they are, NaN and Inf among the others.

    WireError if it is malformed.
    """
    return _decode(_BinaryReader(encoding, message), definition, message)


def _decode(
    reader: "_JsonReader", definition: Definition, message: bytes, *, is_exact: bool = True
) -> dict[str, Any]:
    reader.encoding.check_prefix(message)
    try:
        value = reader.read_message(definition)
    except struct.error as error:
        raise WireError(f"the message ends before its fields do: {error}") from None
    if is_exact or reader.at > len(message):
        reader.encoding.check_end(reader.at, message)
    return value


class _JsonReader:
    """Reads the fields of one message; `at` is the offset of the next one."""

    def __init__(self, encoding: Encoding, data: bytes) -> None:
        self.at = PREFIX
        self.encoding = encoding
        self._data = data

    def read_message(self, definition: Definition) -> dict[str, Any]:
        if not definition.fields and self.encoding is Encoding.CDR:
            self.at += 1
        return {field.name: self._read_field(definition, field) for field in definition.fields}

    def _read_field(self, definition: Definition, field: Field) -> Any:  # noqa: ANN401 - any JSON
        if not field.array:
            return self._read_value(definition, field)
        count = self._read_count(definition, field) if field.length is None else field.length
        if field.type in CODES:
            return self._array(field.type, self._read_numbers(field.type, count))
        return [self._read_value(definition, field) for _ in range(count)]

    def _read_count(self, definition: Definition, field: Field) -> int:
        (count,) = self._unpack("I", 4)
        if count * min_size(field, definition) > len(self._data) - self.at:
            raise WireError(f"{field.name}: {count} elements are announced, fewer are there")
        return int(count)

    def _read_numbers(self, type: str, count: int) -> bytes:
        """Return the bytes of an array of numbers."""
        if count and self.encoding is Encoding.CDR:
            self.at = align_to(SIZES[type], self.at)
        return self._take(count * SIZES[type])

    def _array(self, type: str, data: bytes) -> Any:  # noqa: ANN401 - any JSON
        """Return an array of numbers as JSON has it."""
        if type in BYTE_ARRAYS:
            return base64.b64encode(data).decode()
        code = primitive_code(type, self.encoding)
        values = struct.unpack(f"<{len(data) // SIZES[type]}{code}", data)
        return [self._number(each) for each in values]

    def _number(self, value: Any) -> Any:  # noqa: ANN401 - a primitive value
        """Return a value as JSON has it, which knows neither NaN nor Inf."""
        return None if isinstance(value, float) and not math.isfinite(value) else value

    def _read_value(self, definition: Definition, field: Field) -> Any:  # noqa: ANN401 - any JSON
        if nested := definition.nested.get(field.type):
            return self.read_message(nested)
        if field.type == "string":
            return self._read_string()
        if field.type in ("time", "duration"):
            code = time_code(field.type, self.encoding)
            parts = self._unpack(code, alignment(field.type, Encoding.CDR))
            return dict(zip(TIME_FIELDS[self.encoding], parts, strict=True))
        (value,) = self._unpack(primitive_code(field.type, self.encoding), SIZES[field.type])
        return self._number(value)

    def _read_string(self) -> str:
        (length,) = self._unpack("I", 4)
        text = self._take(length)
        if self.encoding is Encoding.CDR:
            text = text[:-1]
        return text.decode(errors="replace")

    def _take(self, count: int) -> bytes:
        start, self.at = self.at, self.at + count
        if self.at > len(self._data):
            raise WireError(f"{count} bytes are announced, {len(self._data) - start} are left")
        return self._data[start : self.at]

    def _unpack(self, code: str, align: int) -> tuple[Any, ...]:
        if self.encoding is Encoding.CDR:
            self.at = align_to(align, self.at)
        values = struct.unpack_from(f"<{code}", self._data, self.at)
        self.at += struct.calcsize(f"<{code}")
        return values


class _BinaryReader(_JsonReader):
    """Keeps arrays of numbers as they lie in the message, and every float as it is."""

    def _array(self, type: str, data: bytes) -> Any:  # noqa: ANN401 - see above
        return super()._array(type, data) if type == "bool" else NumberArray(type, data)

    def _number(self, value: Any) -> Any:  # noqa: ANN401 - see above
        return value
