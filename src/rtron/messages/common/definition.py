"""Definitions of message types: what fields a message has, and its MD5 sum (ROS wiki: msg)."""

from collections.abc import Mapping
from dataclasses import dataclass, field

HEADER = "std_msgs/Header"
SIZES = {
    "bool": 1,
    "byte": 1,
    "char": 1,
    "int8": 1,
    "uint8": 1,
    "int16": 2,
    "uint16": 2,
    "int32": 4,
    "uint32": 4,
    "float32": 4,
    "int64": 8,
    "uint64": 8,
    "float64": 8,
    "time": 8,
    "duration": 8,
}
"""The bytes that a primitive value takes, except a string's."""
PRIMITIVES = frozenset({*SIZES, "string"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A field: `type` is primitive or `pkg/Name`, `length` that of an array of fixed length.

    ROS 2 bounds what it does not fix: `max_elements` elements of a sequence, `max_bytes` bytes of a
    string.
    """

    name: str
    type: str
    array: bool = False
    length: int | None = None
    max_elements: int | None = None
    max_bytes: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Definition:
    """A message type, `pkg/Name`, with the definitions of the types that its own fields have.

    `md5sum` is ROS 1's, which bounds are part of as they are spelled; `values` are counted as for
    `MAX_VALUES`; `depth` is 1 if no type is nested in it.
    """

    type: str
    fields: tuple[Field, ...]
    md5sum: str
    nested: Mapping[str, "Definition"] = field(default_factory=dict, repr=False, compare=False)
    values: int = field(default=1, repr=False, compare=False)
    depth: int = field(default=1, repr=False, compare=False)
    md5_text: str = field(default="", repr=False, compare=False)
    """What the MD5 sum is of; that of a service is of both its parts' together."""

    def find(self, name: str) -> Field | None:
        """Return the field called `name`."""
        return next((each for each in self.fields if each.name == name), None)
