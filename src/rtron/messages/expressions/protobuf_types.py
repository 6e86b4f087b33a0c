"""A definition as protobuf message types, which the expression language's checker knows fields by.

proto2, since there a field that is set is present (`has`), also where its value is 0.
"""

from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from rtron.errors import InputError
from rtron.messages.common.definition import Definition, Field
from rtron.messages.expressions.geometry import (
    BoundingBox,
    PolygonEdge,
    bounding_box,
    polygon_edges,
)
from rtron.messages.expressions.protobuf_wire import KINDS, is_bytes
from rtron.vocabulary import Area

if TYPE_CHECKING:
    from collections.abc import Iterator

    from google.protobuf.descriptor_pb2 import DescriptorProto, FileDescriptorProto
    from google.protobuf.descriptor_pool import DescriptorPool

AREA = "rtron/Area"
"""The type of an area: its edges, and the box around them."""
_EDGE = "rtron/Edge"
POINT = "geometry_msgs/Point"
_POINT_FIELDS = tuple(Field(name=name, type="float64") for name in ("x", "y", "z"))


def protobuf_name(type: str) -> str:
    """Return the name of a message type: `pkg.Name`."""
    return type.replace("/", ".")


def descriptor_pool(definition: Definition) -> "DescriptorPool":
    """Return a pool with a message type, all those in it, points and areas."""
    from google.protobuf.descriptor_pool import DescriptorPool  # noqa: PLC0415 - for expressions

    pool = DescriptorPool()
    try:
        for file in _area_files():
            pool.AddSerializedFile(file.SerializeToString())
        for each in types_of(definition).values():
            pool.AddSerializedFile(_file(each).SerializeToString())
    except (TypeError, ValueError) as error:
        raise InputError(
            f"the type {definition.type} cannot be used in expressions: {error}"
        ) from error
    return pool


def area_value(make: Any, area: Area) -> Any:  # noqa: ANN401 - a class that protobuf makes
    """Return an area as an instance of `make`, protobuf's class for `AREA`."""
    return make(
        edges=[asdict(edge) for edge in polygon_edges(area.polygon)],
        **asdict(bounding_box(area.polygon)),
    )


def types_of(definition: Definition) -> dict[str, Definition]:
    """Return a message type, those in it and points; a type comes after those that it has."""
    types: dict[str, Definition] = {}
    _collect(definition, types)
    types.setdefault(POINT, Definition(type=POINT, fields=_POINT_FIELDS, md5sum=""))
    return types


def _collect(definition: Definition, types: dict[str, Definition]) -> None:
    for nested in definition.nested.values():
        if nested.type not in types:
            _collect(nested, types)
    types[definition.type] = definition


def _area_files() -> "Iterator[FileDescriptorProto]":
    edge = Definition(type=_EDGE, fields=_numbers(PolygonEdge), md5sum="")
    own = (Field(name="edges", type=_EDGE, array=True), *_numbers(BoundingBox))
    yield _file(edge)
    yield _file(Definition(type=AREA, fields=own, md5sum="", nested={_EDGE: edge}))


def _numbers(kind: type[PolygonEdge] | type[BoundingBox]) -> tuple[Field, ...]:
    return tuple(Field(name=each.name, type="float64") for each in fields(kind))


def _file(definition: Definition) -> "FileDescriptorProto":
    from google.protobuf.descriptor_pb2 import FileDescriptorProto  # noqa: PLC0415 - as above

    package, _, name = definition.type.partition("/")
    file = FileDescriptorProto(name=f"{definition.type}.proto", package=package, syntax="proto2")
    file.dependency.extend(f"{nested}.proto" for nested in definition.nested)
    message = file.message_type.add(name=name)
    for number, field in enumerate(definition.fields, 1):
        if is_usable_name(field.name):
            _add_field(message, field, number)
    return file


def is_usable_name(name: str) -> bool:
    """Tell whether a field does not hide what protobuf's own classes are used by."""
    from google.protobuf.message import Message  # noqa: PLC0415 - as above

    return not hasattr(Message, name)


def _add_field(message: "DescriptorProto", field: Field, number: int) -> None:
    from google.protobuf.descriptor_pb2 import FieldDescriptorProto  # noqa: PLC0415 - as above

    repeated = field.array and not is_bytes(field)
    label = "LABEL_REPEATED" if repeated else "LABEL_OPTIONAL"
    added = message.field.add(
        name=field.name, number=number, label=FieldDescriptorProto.Label.Value(label)
    )
    added.type = FieldDescriptorProto.Type.Value(_type(field))
    if added.type == FieldDescriptorProto.TYPE_MESSAGE:
        added.type_name = "." + protobuf_name(field.type)
    elif repeated and field.type in KINDS:
        added.options.packed = True


def _type(field: Field) -> "str":
    if is_bytes(field):
        return "TYPE_BYTES"
    if field.type == "string":
        return "TYPE_STRING"
    kind = KINDS.get(field.type)
    return kind.type if kind else "TYPE_MESSAGE"
