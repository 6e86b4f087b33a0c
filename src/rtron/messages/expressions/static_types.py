"""The types of expressions that are checked without Google's CEL: what each part gives."""

from dataclasses import dataclass

from rtron.messages.common.definition import Definition, Field
from rtron.messages.expressions.protobuf_types import AREA, is_usable_name, protobuf_name
from rtron.messages.expressions.protobuf_wire import is_bytes


@dataclass(frozen=True, slots=True)
class StaticType:
    """A type as CEL calls it; lists know that of their elements, messages their definition."""

    name: str
    element: "StaticType | None" = None
    definition: Definition | None = None

    def __str__(self) -> str:
        return f"list({self.element or 'dyn'})" if self.is_list else self.name

    @property
    def is_list(self) -> bool:
        """Whether it is a list; one without elements has those of any type."""
        return self.name == "list"

    @property
    def is_plain(self) -> bool:
        """Whether its values compare: no message or area is in it."""
        return self in _PLAIN or (self.is_list and (self.element is None or self.element.is_plain))

    @property
    def is_known(self) -> bool:
        """Whether no list without elements is in it."""
        return not self.is_list or (self.element is not None and self.element.is_known)

    def joined(self, other: "StaticType") -> "StaticType | None":
        """Return the type of what may be a value of either; None if they have none in common."""
        if not (self.is_list and other.is_list):
            return self if self.name == other.name else None
        if self.element is None or other.element is None:
            return other if self.element is None else self
        element = self.element.joined(other.element)
        return list_of(element) if element else None

    def matches(self, other: "StaticType") -> bool:
        """Return whether values of both may stand in the same place."""
        return self.joined(other) is not None


BOOL, INT, DOUBLE, STRING, BYTES = map(StaticType, ("bool", "int", "double", "string", "bytes"))
AREA_TYPE = StaticType(protobuf_name(AREA))
_PLAIN = frozenset({BOOL, INT, DOUBLE, STRING, BYTES})
_OF_PRIMITIVE = {
    "bool": BOOL,
    "string": STRING,
    **dict.fromkeys(("float32", "float64", "time", "duration"), DOUBLE),
}


def list_of(element: StaticType | None) -> StaticType:
    """Return the type of a list."""
    return StaticType("list", element)


def message_type(definition: Definition) -> StaticType:
    """Return the type of a message."""
    return StaticType(protobuf_name(definition.type), definition=definition)


def field_type(message: StaticType, name: str) -> StaticType | None:
    """Return the type of a field; None if the message has no such field, or is none."""
    field = message.definition.find(name) if message.definition else None
    if message.definition is None or field is None or not is_usable_name(name):
        return None
    return _type_of(field, message.definition)


def _type_of(field: Field, owner: Definition) -> StaticType:
    if is_bytes(field):
        return BYTES
    nested = owner.nested.get(field.type)
    single = message_type(nested) if nested else _OF_PRIMITIVE.get(field.type, INT)
    return list_of(single) if field.array else single
