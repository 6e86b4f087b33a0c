"""Where the fields of a message lie: a definition compiled into steps over a message's bytes.

A step takes the message and an offset and returns the offset behind what it read; what it found it
appends to `out`. Neighbouring values of fixed size are one step with one `struct.Struct`. Values
are copied as bytes into a template, so that what becomes of them is up to who lays it out.
"""

import struct
from collections.abc import Callable, Sequence
from typing import Any

from rtron.errors import WireError
from rtron.messages.common.definition import SIZES, Definition, Field
from rtron.messages.common.encoding import PREFIX, Encoding

Step = Callable[[bytes, int, list[Any]], int]
Convert = Callable[[bytes], bytes]

_MAX_ALIGNMENT = 8
_MAX_ZEROS = 1 << 16
_COUNT = struct.Struct("<I")
_COUNT_SIZE = 4


def alignment(type: str, encoding: Encoding) -> int:
    """Return what the offset of a primitive value is a multiple of."""
    if encoding is Encoding.ROS1:
        return 1
    return _COUNT_SIZE if type in ("time", "duration", "string") else SIZES[type]


class MessageLayout:
    """Steps in the making; alignment is settled here as far as offsets are known beforehand.

    Offsets are known modulo `_known`: 8 at the start of a body, 1 behind a string.
    """

    def __init__(self, encoding: Encoding, *, known: int = _MAX_ALIGNMENT) -> None:
        self.encoding = encoding
        self._known = known
        self._offset = 0
        self._steps: list[Step] = []
        self._begin()

    def _begin(self, align: int = 1) -> None:
        self._align = align
        self._format: list[str] = []
        self._template = bytearray()
        self._converts: list[tuple[int, Convert]] = []
        self._values = 0

    def literal(self, text: bytes) -> None:
        """Append `text` to what is found."""
        self._template += text.replace(b"%", b"%%")

    def value(self, size: int, align: int, convert: Convert | None = None) -> None:
        """Append the next `size` bytes to what is found, converted."""
        self._take(f"{size}s", size, align)
        if convert:
            self._converts.append((self._values, convert))
        self._template += b"%b"
        self._values += 1

    def skip(self, size: int, align: int) -> None:
        """Go over the next `size` bytes."""
        self._take(f"{size}x", size, align)

    def step(self, step: Step) -> None:
        """Add a step of its own; nothing is known of the offset behind it."""
        self._flush()
        self._steps.append(step)
        self._known = 1

    def steps(self) -> tuple[Step, ...]:
        """Return the steps; the layout is used up."""
        self._flush()
        return tuple(self._steps)

    def _take(self, code: str, size: int, align: int) -> None:
        if align > self._known:
            self._flush()
            self._begin(align)
            self._known, self._offset = align, 0
        padding = -self._offset % align
        if padding:
            self._format.append(f"{padding}x")
        self._format.append(code)
        self._offset = (self._offset + padding + size) % _MAX_ALIGNMENT

    def _flush(self) -> None:
        if self._format or self._template:
            self._steps.append(self._run())
        self._begin()

    def _run(self) -> Step:
        source = struct.Struct("<" + "".join(self._format))
        if not self._template:
            return _skip_run(source.size, self._align)
        return _copy_run(source, bytes(self._template), self._align, self._converts)


def _skip_run(size: int, align: int) -> Step:
    mask = align - 1

    def skip(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        return at + (PREFIX - at & mask) + size

    return skip


def _copy_run(
    source: struct.Struct, template: bytes, align: int, converts: Sequence[tuple[int, Convert]]
) -> Step:
    unpack, size, mask = source.unpack_from, source.size, align - 1

    def copy(data: bytes, at: int, out: list[Any]) -> int:
        at += PREFIX - at & mask
        out.append(template % unpack(data, at))
        return at + size

    def convert(data: bytes, at: int, out: list[Any]) -> int:
        at += PREFIX - at & mask
        values = list(unpack(data, at))
        for index, change in converts:
            values[index] = change(values[index])
        out.append(template % tuple(values))
        return at + size

    return convert if converts else copy


def count_reader(
    encoding: Encoding, min_element_size: int
) -> Callable[[bytes, int], tuple[int, int]]:
    """Return what reads a length and gives it with the offset behind it.

    `min_element_size` is the size of the smallest element: WireError if so many cannot follow.
    """
    mask = 0 if encoding is Encoding.ROS1 else _COUNT_SIZE - 1

    def read(data: bytes, at: int) -> tuple[int, int]:
        at += PREFIX - at & mask
        count: int = _COUNT.unpack_from(data, at)[0]
        at += _COUNT_SIZE
        if count * min_element_size > len(data) - at:
            raise WireError(f"{count} elements are announced, {len(data) - at} bytes are left")
        return count, at

    return read


def align_to(align: int, at: int) -> int:
    """Return the first offset from `at` on that a value with this alignment may have."""
    return at + (PREFIX - at & align - 1)


def min_size(field: Field, definition: Definition) -> int:
    """Return the number of bytes that one value of a field takes at least; 1 for an empty one."""
    nested = definition.nested.get(field.type)
    if nested is None:
        return SIZES.get(field.type, _COUNT_SIZE)
    return max(1, sum(_min_total(each, nested) for each in nested.fields))


def _min_total(field: Field, definition: Definition) -> int:
    if field.array and field.length is None:
        return _COUNT_SIZE
    return min_size(field, definition) * (field.length or 1)


def skip_field(layout: MessageLayout, field: Field, definition: Definition) -> None:
    """Lay out a field that nobody asks for."""
    if field.array:
        _skip_array(layout, field, definition)
    elif nested := definition.nested.get(field.type):
        skip_fields(layout, nested)
    elif field.type == "string":
        layout.step(_skip_block(layout.encoding, 1, 1))
    else:
        layout.skip(SIZES[field.type], alignment(field.type, layout.encoding))


def skip_fields(layout: MessageLayout, definition: Definition) -> None:
    """Lay out a message that nobody asks for."""
    lay_out_empty_message(layout, definition)
    for field in definition.fields:
        skip_field(layout, field, definition)


def lay_out_empty_message(layout: MessageLayout, definition: Definition) -> None:
    """Lay out the byte that ROS 2 gives a message without fields, since IDL has none such."""
    if not definition.fields and layout.encoding is Encoding.CDR:
        layout.skip(1, 1)


def _skip_array(layout: MessageLayout, field: Field, definition: Definition) -> None:
    encoding = layout.encoding
    if field.type not in SIZES:
        layout.step(each_element(layout, field, definition, skip_field))
    elif field.length is None:
        align = alignment(field.type, encoding)
        layout.step(_skip_block(encoding, SIZES[field.type], align))
    else:
        layout.skip(field.length * SIZES[field.type], alignment(field.type, encoding))


def _skip_block(encoding: Encoding, size: int, align: int) -> Step:
    count_of = count_reader(encoding, size)

    def skip(data: bytes, at: int, out: list[Any]) -> int:  # noqa: ARG001
        count, at = count_of(data, at)
        return align_to(align, at) + count * size if count else at

    return skip


def each_element(
    layout: MessageLayout,
    field: Field,
    definition: Definition,
    lay_out: Callable[[MessageLayout, Field, Definition], None],
) -> Step:
    """Return the step over an array whose elements `lay_out` lays out, one after the other."""
    single = Field(name=field.name, type=field.type, max_bytes=field.max_bytes)
    inner = MessageLayout(layout.encoding, known=1)
    lay_out(inner, single, definition)
    steps = inner.steps()
    count_of = count_reader(layout.encoding, min_size(single, definition))
    fixed = field.length

    def loop(data: bytes, at: int, out: list[Any]) -> int:
        count, at = (fixed, at) if fixed is not None else count_of(data, at)
        for _ in range(count):
            for step in steps:
                at = step(data, at, out)
        return at

    return loop


def zero_body_size(definition: Definition, encoding: Encoding) -> int | None:
    """Return the size of the body in which every number is 0 and everything else empty.

    None if it is larger than 64 KiB.
    """
    layout = MessageLayout(encoding)
    skip_fields(layout, definition)
    zeros = bytes(PREFIX + _MAX_ZEROS)
    at = PREFIX
    try:
        for step in layout.steps():
            at = step(zeros, at, [])
    except (struct.error, WireError):
        return None
    return at - PREFIX if at <= len(zeros) else None


def message_reader(steps: Sequence[Step], encoding: Encoding) -> Callable[[bytes], list[Any]]:
    """Return what takes the steps over a whole message; WireError if it is malformed."""

    def read(message: bytes) -> list[Any]:
        encoding.check_prefix(message)
        out: list[Any] = []
        at = PREFIX
        try:
            for step in steps:
                at = step(message, at, out)
        except struct.error as error:
            raise WireError(f"the message ends before its fields do: {error}") from error
        encoding.check_end(at, message)
        return out

    return read
