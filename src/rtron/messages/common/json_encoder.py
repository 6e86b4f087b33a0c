"""A message as JSON, written as its bytes: every field is checked against the type's definition.

The JSON is a stranger's: what does not fit is a WireError that names the field. Fields that are
left out are zero or empty, a stamp that is left out is the present time (rosbridge v2.0, 3.3.3).
"""

import base64
import binascii
import math
import struct
from collections.abc import Mapping
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import HEADER, SIZES, Definition, Field
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import alignment

CODES = {
    "bool": "?",
    "byte": "b",
    "char": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""How `struct` calls the primitive types; a byte of ROS 2 is `B`."""
TIME_FIELDS = {Encoding.ROS1: ("secs", "nsecs"), Encoding.CDR: ("sec", "nanosec")}
"""How the parts of a time are called in JSON."""
BYTE_ARRAYS = ("uint8", "char")
"""The types whose arrays are base64 in JSON."""
_SECOND = 1_000_000_000
_MAX_SHOWN = 40
_MAX_MISSING = 20


def primitive_code(type: str, encoding: Encoding) -> str:
    """Return how `struct` calls a primitive type of an encoding."""
    return "B" if type == "byte" and encoding is Encoding.CDR else CODES[type]


def time_code(type: str, encoding: Encoding) -> str:
    """Return how `struct` calls a time or a duration: only ROS 1's time has no sign."""
    if encoding is Encoding.CDR:
        return "iI"
    return "II" if type == "time" else "ii"


def encode_json(
    definition: Definition, encoding: Encoding, value: object, wall_time: int, max_bytes: int
) -> tuple[bytes, tuple[str, ...]]:
    """Return a message's bytes, and the names of the fields that were left out.

    `wall_time` (ns since 1970) is for stamps. WireError if the value does not fit the definition,
    or if it becomes longer than `max_bytes`: what is left out takes no room in JSON.
    """
    writer = _JsonWriter(encoding, wall_time, max_bytes)
    writer.write_message(definition, value, "")
    writer.check_size()
    return encoding.prefix(len(writer.body)) + bytes(writer.body), tuple(writer.missing)


class _JsonWriter:
    """Writes the fields of one message behind each other; `path` names the field in errors."""

    def __init__(self, encoding: Encoding, wall_time: int, max_bytes: int) -> None:
        self.body = bytearray()
        self.missing: list[str] = []
        self._encoding = encoding
        self._wall_time = wall_time
        self._max_bytes = max_bytes

    def write_message(self, definition: Definition, value: object, path: str) -> None:
        if not isinstance(value, Mapping):
            raise _misfit(path or definition.type, "an object", value)
        for name in value.keys() - {field.name for field in definition.fields}:
            raise WireError(f"{definition.type} has no field {_shown(name)}")
        if not definition.fields and self._encoding is Encoding.CDR:
            self._pack("B", 1, 0)
        for field in definition.fields:
            place = f"{path}.{field.name}" if path else field.name
            self._write_field(definition, field, value, place)

    def check_size(self) -> None:
        if len(self.body) > self._max_bytes:
            raise WireError(f"the message has more than {self._max_bytes} bytes")

    def _write_field(
        self, definition: Definition, field: Field, value: Mapping[str, Any], path: str
    ) -> None:
        given = value.get(field.name)
        self.check_size()
        if field.name not in value:
            if len(self.missing) < _MAX_MISSING:
                self.missing.append(path)
            given = self._default(definition, field)
        if field.array:
            self._write_array(definition, field, given, path)
        else:
            self._write_value(definition, field, given, path)

    def _default(self, definition: Definition, field: Field) -> Any:  # noqa: ANN401 - any JSON
        if field.array:
            return [self._zero(field)] * (field.length or 0)
        if definition.type == HEADER and field.type == "time":
            seconds, rest = divmod(self._wall_time, _SECOND)
            return dict(zip(TIME_FIELDS[self._encoding], (seconds, rest), strict=True))
        return self._zero(field)

    def _zero(self, field: Field) -> Any:  # noqa: ANN401 - any JSON
        if field.type == "string":
            return ""
        if field.type == "bool":
            return False
        return 0 if field.type in CODES else {}

    def _write_array(self, definition: Definition, field: Field, value: object, path: str) -> None:
        if isinstance(value, str) and field.type in BYTE_ARRAYS:
            value = _from_base64(value, path)
        if not isinstance(value, (list, bytes)):
            raise _misfit(path, "a list", value)
        self._check_length(field, len(value), path)
        if field.length is None:
            self._pack("I", 4, len(value))
        if field.type in CODES:
            self._write_numbers(field, value, path)
        else:
            for number, item in enumerate(value):
                self._write_value(definition, field, item, f"{path}[{number}]")

    def _check_length(self, field: Field, length: int, path: str) -> None:
        if field.length is not None and length != field.length:
            raise WireError(f"{path} has {field.length} elements, not {length}")
        if field.max_elements is not None and length > field.max_elements:
            raise WireError(f"{path} has at most {field.max_elements} elements, not {length}")

    def _write_numbers(self, field: Field, value: "list[Any] | bytes", path: str) -> None:
        if isinstance(value, list):
            for number, item in enumerate(value):
                _check_number(field.type, item, f"{path}[{number}]")
        code = primitive_code(field.type, self._encoding)
        if value:
            self._pack(f"{len(value)}{code}", SIZES[field.type], *value, path=path)

    def _write_value(self, definition: Definition, field: Field, value: object, path: str) -> None:
        if nested := definition.nested.get(field.type):
            self.write_message(nested, value, path)
        elif field.type == "string":
            self._write_string(field, value, path)
        elif field.type in ("time", "duration"):
            self._write_time(field.type, value, path)
        else:
            _check_number(field.type, value, path)
            code = primitive_code(field.type, self._encoding)
            self._pack(code, SIZES[field.type], value, path=path)

    def _write_string(self, field: Field, value: object, path: str) -> None:
        if not isinstance(value, str):
            raise _misfit(path, "a string", value)
        try:
            data = value.encode()
        except UnicodeEncodeError:
            raise WireError(f"{path} is no text: it has half of a surrogate pair") from None
        if field.max_bytes is not None and len(data) > field.max_bytes:
            raise WireError(f"{path} has at most {field.max_bytes} bytes, not {len(data)}")
        if self._encoding is Encoding.CDR:
            if b"\0" in data:
                raise WireError(f"{path} has the character NUL, which ends a string of ROS 2")
            data += b"\0"
        self._pack("I", 4, len(data))
        self.body += data

    def _write_time(self, type: str, value: object, path: str) -> None:
        names = TIME_FIELDS[self._encoding]
        if not isinstance(value, Mapping):
            raise _misfit(path, f"an object with {' and '.join(names)}", value)
        for name in value.keys() - set(names):
            raise WireError(f"{path} has {' and '.join(names)}, not {_shown(name)}")
        parts = [value.get(name, 0) for name in names]
        for name, part in zip(names, parts, strict=True):
            _check_number("int32", part, f"{path}.{name}")
        if not abs(parts[1]) < _SECOND:
            raise WireError(f"{path}.{names[1]} is no part of a second")
        self._pack(
            time_code(type, self._encoding), alignment(type, Encoding.CDR), *parts, path=path
        )

    def _pack(self, code: str, align: int, *values: Any, path: str = "") -> None:  # noqa: ANN401
        """Append values; `align` counts in CDR only."""
        if self._encoding is Encoding.CDR:
            self.body += bytes(-len(self.body) % align)
        try:
            self.body += struct.pack(f"<{code}", *values)
        except (struct.error, OverflowError):
            raise WireError(f"{path}: the number is out of the range of its type") from None


def _check_number(type: str, value: object, path: str) -> None:
    """Refuse (WireError) what is no value of a primitive type; its range is checked elsewhere."""
    if type == "bool":
        if not isinstance(value, bool):
            raise _misfit(path, "true or false", value)
    elif type in ("float32", "float64"):
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise _misfit(path, "a number", value)
        if isinstance(value, float) and not math.isfinite(value):
            raise WireError(f"{path} is NaN or Inf, which moves nothing safely")
    elif isinstance(value, bool) or not isinstance(value, int):
        raise _misfit(path, "a whole number", value)


def _from_base64(text: str, path: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise WireError(f"{path} is neither a list nor base64") from None


def _misfit(path: str, expected: str, value: object) -> WireError:
    return WireError(f"{path} is {expected}, not {_shown(value)}")


def _shown(value: object) -> str:
    kinds: dict[type, str] = {dict: "an object", list: "a list", type(None): "null"}
    return kinds.get(type(value)) or ascii(str(value)[:_MAX_SHOWN])
