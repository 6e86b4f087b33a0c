"""Message types as publishers state them, and codecs for their messages."""

from collections.abc import Callable

from rtron.errors import InputError, WireError
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry, standard_text
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.finite_numbers import finite_checker
from rtron.messages.common.stamp import stamp_reader
from rtron.messages.common.velocity import VELOCITY_TYPES, VelocityCodec, velocity_codec
from rtron.policies.velocity_limit.frame_counter import NO_STAMP
from rtron.vocabulary import normalise_type

_STANDARD_DEFINITIONS = {
    Encoding.ROS1: DefinitionRegistry(),
    Encoding.CDR: DefinitionRegistry(ros=2),
}


def standard_info(type: str, encoding: Encoding) -> TypeInfo | None:
    """Return the type information of a standard type; None if the type is not standard."""
    name = normalise_type(type)
    definition = _known_definition(name, encoding)
    text = standard_text(name, 1 if encoding is Encoding.ROS1 else 2)
    if definition is None or text is None:
        return None
    return TypeInfo(name, definition.md5sum, text)


def codec_of(info: TypeInfo, encoding: Encoding) -> VelocityCodec | None:
    """Return a codec for the velocities of a publisher, None if its messages hold none."""
    if normalise_type(info.type) not in VELOCITY_TYPES:
        return None
    definition = _definition(info, encoding)
    return velocity_codec(definition, encoding) if definition else None


def number_checker(info: TypeInfo, encoding: Encoding) -> Callable[[bytes], object]:
    """Return what refuses (WireError) a publisher's commands with floats that are no numbers."""
    definition = _definition(info, encoding)
    return finite_checker(definition, encoding) if definition else _refuse_unknown


def stamp_of(info: TypeInfo, encoding: Encoding) -> Callable[[bytes], int]:
    """Return a reader of message stamps; messages without a stamp have stamp 0."""
    definition = _definition(info, encoding)
    reader = stamp_reader(definition, encoding) if definition else None
    return reader or _no_stamp


def _definition(info: TypeInfo, encoding: Encoding) -> Definition | None:
    """Return the definition with the publisher's MD5 sum: the publisher's, or an installed one."""
    stated = _stated_definition(info)
    if stated and stated.md5sum == info.md5sum:
        return stated
    known = _known_definition(info.type, encoding)
    return known if known and known.md5sum == info.md5sum else None


def _known_definition(type: str, encoding: Encoding) -> Definition | None:
    """Return the definition of a standard or installed type; None if it cannot be used."""
    try:
        return _STANDARD_DEFINITIONS[encoding].find(type)
    except InputError:
        return None


def _stated_definition(info: TypeInfo) -> Definition | None:
    try:
        return parse_definition(info.type, info.definition)
    except InputError:
        return None


def _refuse_unknown(_message: bytes) -> None:
    raise WireError("nobody knows the definition")


def _no_stamp(_message: bytes) -> int:
    return NO_STAMP
