"""A frame as CBOR (RFC 8949), with arrays of numbers as typed arrays (RFC 8746), little-endian.

Only what goes out: a client sends JSON. Values are those of a decoded message.
"""

import struct
from collections.abc import Mapping
from typing import Any

from rtron.messages.common.json_decoder import NumberArray

_UNSIGNED, _NEGATIVE, _BYTES, _TEXT, _LIST, _MAP, _TAG = (kind << 5 for kind in range(7))
_FALSE, _TRUE, _NULL = b"\xf4", b"\xf5", b"\xf6"
_DOUBLE = struct.Struct(">d")
_FLOAT = b"\xfb"
_SMALL = 24
_HEADS = ((1 << 8, 24, ">BB"), (1 << 16, 25, ">BH"), (1 << 32, 26, ">BI"), (1 << 64, 27, ">BQ"))
"""For numbers below the first: what the head adds, and how head and number are packed."""
_TAGS = {
    "uint16": 69,
    "uint32": 70,
    "uint64": 71,
    "int8": 72,
    "byte": 72,
    "int16": 77,
    "int32": 78,
    "int64": 79,
    "float32": 85,
    "float64": 86,
}
"""The tags of typed arrays; bytes have none, as rosbridge sends them."""


def encode_cbor(value: Any) -> bytes:  # noqa: ANN401 - what a message has
    """Return a value of a decoded message as CBOR."""
    out = bytearray()
    _append(out, value)
    return bytes(out)


def _append(out: bytearray, value: Any) -> None:  # noqa: ANN401 - see above
    if value is None or isinstance(value, bool):
        out += _NULL if value is None else _TRUE if value else _FALSE
    elif isinstance(value, int):
        out += _head(_UNSIGNED, value) if value >= 0 else _head(_NEGATIVE, -1 - value)
    elif isinstance(value, float):
        out += _FLOAT + _DOUBLE.pack(value)
    elif isinstance(value, str):
        data = value.encode()
        out += _head(_TEXT, len(data)) + data
    elif isinstance(value, NumberArray):
        tag = _TAGS.get(value.type)
        out += (_head(_TAG, tag) if tag else b"") + _head(_BYTES, len(value.data)) + value.data
    else:
        _append_items(out, value)


def _append_items(out: bytearray, value: Any) -> None:  # noqa: ANN401 - see above
    if isinstance(value, Mapping):
        out += _head(_MAP, len(value))
        for key, item in value.items():
            _append(out, key)
            _append(out, item)
        return
    out += _head(_LIST, len(value))
    for item in value:
        _append(out, item)


def _head(kind: int, number: int) -> bytes:
    """Return the head of an item: its kind, and a number that is its value or its length."""
    if number < _SMALL:
        return bytes((kind | number,))
    for limit, more, code in _HEADS:
        if number < limit:
            return struct.pack(code, kind | more, number)
    raise OverflowError("no message has so large a number")
