"""Whether bytes are one well-formed CDR message of a type, from the first to the last.

What a reader of ROS 2 refuses is refused here, and what readers of different languages understand
differently too: a boolean that is neither 0 nor 1, a string without its end or with one in its
middle. What has no such traps is gone over without being looked at, however many elements it has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.messages.common.layout import (
    MessageLayout,
    Step,
    alignment,
    count_reader,
    each_element,
    lay_out_empty_message,
    message_reader,
    min_size,
    skip_field,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_ALIGNMENTS = 8
_COUNT_BITS = 32
_BOOLEANS = b"\x00\x01"
_ANY_COUNT = count_reader(Encoding.CDR, 1)


def cdr_validator(definition: Definition) -> Callable[[bytes], object]:
    """Return what refuses (WireError) all but exactly one CDR message of this type."""
    layout = MessageLayout(Encoding.CDR)
    _fields(layout, definition)
    return message_reader(layout.steps(), Encoding.CDR)


def _fields(layout: MessageLayout, definition: Definition) -> None:
    lay_out_empty_message(layout, definition)
    for field in definition.fields:
        _field(layout, field, definition)


def _field(layout: MessageLayout, field: Field, definition: Definition) -> None:
    if field.array:
        _array(layout, field, definition)
    elif nested := definition.nested.get(field.type):
        _fields(layout, nested)
    elif field.type == "string":
        layout.step(_string(field))
    elif field.type == "bool":
        layout.value(1, 1, _check_boolean)
    else:
        layout.skip(SIZES[field.type], alignment(field.type, layout.encoding))


def _array(layout: MessageLayout, field: Field, definition: Definition) -> None:
    if field.max_elements is not None:
        layout.step(_at_most(field))
    if field.type == "bool":
        layout.step(_check_booleans(field))
    elif field.type in SIZES:
        skip_field(layout, field, definition)
    elif field.type != "string" and _is_plain(definition.nested[field.type]):
        layout.step(_skip_plain_array(field, definition))
    else:
        layout.step(each_element(layout, field, definition, _field))


def _is_plain(definition: Definition) -> bool:
    """Tell whether all messages of a type are of one length and nothing in them can be wrong."""
    return all(
        _is_plain(definition.nested[each.type])
        if each.type in definition.nested
        else each.type not in ("string", "bool")
        for each in definition.fields
    ) and not any(each.array and each.length is None for each in _every_field(definition))


def _every_field(definition: Definition) -> Sequence[Field]:
    inner = (each for nested in definition.nested.values() for each in _every_field(nested))
    return [*definition.fields, *inner]


def _check_boolean(value: bytes) -> bytes:
    if value not in _BOOLEANS:
        raise WireError(f"{value[0]} is not a boolean")
    return value


def _check_booleans(field: Field) -> Step:
    fixed = field.length

    def check(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count, at = (fixed, at) if fixed is not None else _ANY_COUNT(data, at)
        if strange := data[at : at + count].translate(None, _BOOLEANS):
            raise WireError(f"{strange[0]} in {field.name} is not a boolean")
        return at + count

    return check


def _string(field: Field) -> Step:
    longest = field.max_bytes

    def check(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count, at = _ANY_COUNT(data, at)
        end = at + count
        if data.find(0, at, end) != end - 1:
            raise WireError(f"a string in {field.name} does not end with its one NUL")
        if longest is not None and count > longest + 1:
            raise WireError(f"a string in {field.name} is longer than {longest} bytes")
        return end

    return check


def _at_most(field: Field) -> Step:
    """Return the step that looks at a sequence's count and goes no further."""
    most = field.max_elements or 0

    def check(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count = _ANY_COUNT(data, at)[0]
        if count > most:
            raise WireError(f"{field.name} has {count} elements, at most {most}")
        return at

    return check


def _skip_plain_array(field: Field, definition: Definition) -> Step:
    """Return the step over an array of plain messages, in at most 32 hops whatever its length.

    How far 2^n messages reach depends only on the alignment of the first: `hops[n][at % 8]`.
    """
    hops = [_hops(definition.nested[field.type])]
    while len(hops) < _COUNT_BITS:
        last = hops[-1]
        hops.append([far + last[(at + far) % _ALIGNMENTS] for at, far in enumerate(last)])
    fixed = field.length
    count_of = count_reader(Encoding.CDR, min_size(field, definition))

    def leap(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count, at = (fixed, at) if fixed is not None else count_of(data, at)
        at -= PREFIX
        for far in hops:
            if count & 1:
                at += far[at % _ALIGNMENTS]
            count >>= 1
        return at + PREFIX

    return leap


def _hops(definition: Definition) -> list[int]:
    """Return how far one plain message reaches, for each offset modulo 8 that it may begin at."""
    layout = MessageLayout(Encoding.CDR, known=1)
    _fields(layout, definition)
    steps = layout.steps()
    return [_reach(steps, PREFIX + offset) for offset in range(_ALIGNMENTS)]


def _reach(steps: Sequence[Step], start: int) -> int:
    at = start
    for step in steps:
        at = step(b"", at, [])
    return at - start
