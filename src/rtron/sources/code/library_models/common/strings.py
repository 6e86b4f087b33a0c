"""Methods of strings, in both languages, on strings that may be known in part."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from string import Formatter
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.shown_text import repr_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    MAX_LENGTH,
    LibraryFunction,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    parts_of,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import return_owner

MAX_LONG_LENGTH = 2**20
"""The most that a method leaves of a text longer than that, as the description of a robot is."""
_CHARACTERS_PER_STEP = 64
"""As many characters of a long text take a step."""
_STR_METHODS = [
    *("strip", "lstrip", "rstrip", "lower", "upper", "title", "capitalize", "swapcase"),
    *("replace", "startswith", "endswith", "find", "rfind", "index", "count", "isdigit"),
    *("isalpha", "isalnum", "isupper", "islower", "zfill", "removeprefix", "removesuffix"),
    *("ljust", "rjust", "center", "casefold", "isnumeric", "isidentifier", "isspace"),
]

_PARTWISE_METHODS = frozenset({"lower", "upper", "replace", "swapcase"})
_PADDING_METHODS = frozenset({"zfill", "ljust", "rjust", "center"})
_STRIP_METHODS = frozenset({"strip", "lstrip", "rstrip"})


def _call_str_method(
    name: str, machine: AbstractMachine, owner: Value, arguments: Arguments
) -> Value:
    values = arguments.values
    if not all(isinstance(value, Scalar) for value in values):
        return owner if name in _STRIP_METHODS else Unknown(name, is_tainted(owner))
    if isinstance(owner, PartialText):
        return _call_on_parts(name, owner, [value.value for value in values])  # type: ignore[union-attr]
    if not isinstance(owner, Scalar):
        keeps_owner = name in _PARTWISE_METHODS | _STRIP_METHODS
        return owner if keeps_owner else Unknown(name, is_tainted(owner))
    try:
        found = _call_bounded(machine, name, owner.value, [value.value for value in values])  # type: ignore[union-attr]
    except (TypeError, ValueError, AttributeError):
        return Unknown(name)
    return Scalar(found, owner.tainted)


def _call_bounded(machine: AbstractMachine, name: str, text: Any, values: list[Any]) -> Any:  # noqa: ANN401 - any Python values
    """Return what a method gives; raise ValueError where that may be too long."""
    most = _max_result_length(name, text, values)
    if most > (MAX_LENGTH if len(text) <= MAX_LENGTH else MAX_LONG_LENGTH):
        raise ValueError(f"more than {MAX_LENGTH} characters")
    machine.count_steps(most // _CHARACTERS_PER_STEP)
    return getattr(text, name)(*values)


def _max_result_length(name: str, text: str, values: list[Any]) -> int:
    """Return how many characters a method leaves at most; case changes only where they are."""
    if name == "replace":
        old, new = values[:2]
        return len(text) + text.count(old) * max(0, len(new) - len(old))
    return max(len(text), *values[:1]) if name in _PADDING_METHODS else len(text)


def _call_on_parts(name: str, owner: PartialText, values: list[Any]) -> Value:
    """Do to the known parts of a string what its method does to the whole."""
    if name in {"startswith", "endswith"}:
        return _starts_or_ends_with(name, owner, values)
    last = len(owner.parts) - 1
    touched = {"lstrip": {0}, "rstrip": {last}, "strip": {0, last}}.get(name, range(last + 1))
    if name not in _PARTWISE_METHODS and name not in _STRIP_METHODS:
        return Unknown(name, owner.tainted)
    method = {(0, "strip"): "lstrip", (last, "strip"): "rstrip"}
    try:
        parts = [
            getattr(part, method.get((at, name), name))(*values)
            if isinstance(part, str) and at in touched
            else part
            for at, part in enumerate(owner.parts)
        ]
    except (TypeError, ValueError):
        return Unknown(name, owner.tainted)
    return concat(
        [part if isinstance(part, Unknown) else Scalar(part, owner.tainted) for part in parts]
    )


def _starts_or_ends_with(name: str, owner: PartialText, values: list[Any]) -> Value:
    part = owner.parts[0 if name == "startswith" else -1]
    affix = values[0] if values else None
    if isinstance(part, str) and isinstance(affix, str) and len(part) >= len(affix):
        return Scalar(getattr(part, name)(affix), owner.tainted)
    return Unknown(name, owner.tainted)


def _split(name: str, _: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    separator = arguments.get(0, "sep")
    if not isinstance(owner, Scalar) or isinstance(separator, (Unknown, PartialText)):
        return Unknown(name)
    given = separator.value if isinstance(separator, Scalar) else None
    limit = arguments.get(1, "maxsplit")
    most = limit.value if isinstance(limit, Scalar) and isinstance(limit.value, int) else -1
    try:
        pieces = getattr(str(owner.value), name)(given or None, most)
    except (TypeError, ValueError):
        return Unknown(name)
    return list_of([Scalar(piece, owner.tainted) for piece in pieces])


def _splitlines(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    if not isinstance(owner, Scalar):
        return Unknown("splitlines", is_tainted(owner))
    return list_of([Scalar(line, owner.tainted) for line in str(owner.value).splitlines()])


def _encode_or_decode(_: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """Text and bytes are one here; what `errors` leaves out is not known."""
    plain = isinstance(owner, Scalar) and str(owner.value).isascii()
    known = plain or not arguments.get(1, "errors")
    return owner if known else Unknown("encode", is_tainted(owner))


def _partition(name: str, _: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    separator = arguments.get(0)
    if isinstance(owner, Scalar) and isinstance(separator, Scalar) and separator.value:
        pieces = getattr(str(owner.value), name)(str(separator.value))
        return list_of([Scalar(piece, owner.tainted) for piece in pieces], "tuple")
    return Unknown(name)


def _join(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    if not certain:
        return Unknown("join")
    spread = [part for item in items for part in (owner, item)]
    return concat(spread[1:])


def fill_fields(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`"…".format(…)`: fields by position and name, with attributes and elements."""
    parts: list[Value] = []
    for part in parts_of(owner):
        if isinstance(part, Unknown):
            parts.append(part)
        else:
            parts.extend(_format_fields(machine, part, arguments))
    return concat(parts)


def _format_fields(machine: AbstractMachine, text: str, arguments: Arguments) -> list[Value]:
    parts: list[Value] = []
    try:
        pieces = list(Formatter().parse(text))
    except ValueError:
        return [Unknown("format")]
    index = 0
    for before, name, spec, conversion in pieces:
        parts.append(Scalar(before))
        if name is not None:
            is_next = not name or name[0] in ".["
            value = _format_field(machine, f"{index}{name}" if is_next else name, arguments)
            is_repr = conversion in {"r", "a"}
            value = repr_of(value) if is_repr else machine.runtime.shown(value)
            index += is_next
            later = arguments.values[index if is_next else 0 :]
            written = _format_spec(machine, spec or "", replace(arguments, values=later))
            parts.append(apply_format_spec(value, written))
    return parts


def _format_spec(machine: AbstractMachine, spec: str, arguments: Arguments) -> str:
    """Return a format with the fields in it put in: `0{}d`."""
    if "{" not in spec:
        return spec
    return text_with_holes(concat(_format_fields(machine, spec, arguments)))


def _format_field(machine: AbstractMachine, name: str, arguments: Arguments) -> Value:
    key = re.split(r"[.\[]", name, maxsplit=1)[0]
    value = arguments.get(int(key)) if key.isdigit() else arguments.keywords.get(key)
    for attribute, item in re.findall(r"\.(\w+)|\[([^\]]*)\]", name[len(key) :]):
        if value is None:
            break
        if attribute:
            value = machine.runtime.attribute(value, attribute, ())
        else:
            value = element(value, Scalar(int(item) if item.isdigit() else item))
    return Unknown(name) if value is None else value


def apply_format_spec(value: Value, spec: str) -> Value:
    """Return a value as `format(value, spec)` shows it; as it is where it is not known."""
    if spec and isinstance(value, Scalar) and len(spec) < 8:  # noqa: PLR2004
        try:
            return Scalar(format(value.value, spec), value.tainted)
        except (TypeError, ValueError):
            return Unknown(spec, value.tainted)
    return value


def _length(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    if isinstance(owner, Scalar):
        return Scalar(len(str(owner.value)), owner.tainted)
    return Unknown("size")


def _empty(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    if isinstance(owner, Scalar):
        return Scalar(not owner.value, owner.tainted)
    sure = isinstance(owner, PartialText) and any(
        isinstance(part, str) and part for part in owner.parts
    )
    return Scalar(value=False) if sure else Unknown("empty", is_tainted(owner))


def _substr(_: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    numbers = [value.value for value in arguments.values if isinstance(value, Scalar)]
    if not isinstance(owner, Scalar) or len(numbers) != len(arguments.values):
        return Unknown("substr")
    if not all(isinstance(number, int) for number in numbers):
        return Unknown("substr")
    start = numbers[0] if numbers else 0
    end = start + numbers[1] if len(numbers) > 1 else None
    return Scalar(str(owner.value)[start:end], owner.tainted)


def _find(name: str, _: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    sought = arguments.get(0)
    if not (isinstance(owner, Scalar) and isinstance(sought, Scalar)):
        return Unknown(name)
    return Scalar(getattr(str(owner.value), name)(str(sought.value)))


def _compare(_: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    other = arguments.get(0)
    if not (isinstance(owner, Scalar) and isinstance(other, Scalar)):
        return Unknown("compare")
    left, right = str(owner.value), str(other.value)
    return Scalar((left > right) - (left < right), owner.tainted)


def _at(_: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    index = arguments.get(0) or Scalar(0)
    if isinstance(owner, Scalar) and isinstance(index, Scalar) and owner.value:
        text = str(owner.value)
        if isinstance(index.value, int) and -len(text) <= index.value < len(text):
            return Scalar(text[index.value], owner.tainted)
    return Unknown("at")


def _format_map(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`"…".format_map(mapping)`."""
    given = arguments.get(0)
    entries = given.entries if isinstance(given, MapValue) else {}
    words = {str(key): value for key, value in entries.items()}
    return fill_fields(machine, owner, replace(arguments, values=(), keywords=words))


StringMethods = Mapping[str, Callable[..., Value]]

PYTHON_STRING_METHODS: StringMethods = {
    **{name: partial(_call_str_method, name) for name in _STR_METHODS},
    **{name: partial(_split, name) for name in ("split", "rsplit")},
    **{name: partial(_partition, name) for name in ("partition", "rpartition")},
    "join": _join,
    "format": fill_fields,
    "format_map": _format_map,
    "encode": _encode_or_decode,
    "decode": _encode_or_decode,
    "splitlines": _splitlines,
}


def _cpp_starts_or_ends_with(
    name: str, _: AbstractMachine, owner: Value, arguments: Arguments
) -> Value:
    """`text.starts_with(part)`, `text.ends_with(part)`."""
    part = arguments.get(0)
    if isinstance(owner, Scalar) and isinstance(part, Scalar) and isinstance(part.value, str):
        text = str(owner.value)
        found = text.startswith(part.value) if name == "starts_with" else text.endswith(part.value)
        return Scalar(found, owner.tainted)
    return Unknown(name)


CPP_STRING_METHODS: StringMethods = {
    **dict.fromkeys(("c_str", "data", "str", "toStdString", "toUtf8", "constData"), return_owner),
    **dict.fromkeys(("string", "generic_string"), return_owner),
    **{name: partial(_cpp_starts_or_ends_with, name) for name in ("starts_with", "ends_with")},
    **dict.fromkeys(("size", "length"), _length),
    "empty": _empty,
    "substr": _substr,
    "find": partial(_find, "find"),
    "rfind": partial(_find, "rfind"),
    "compare": _compare,
    "at": _at,
    "front": _at,
    "back": lambda machine, owner, arguments: _at(
        machine, owner, arguments.with_values(Scalar(-1))
    ),
}


def bound_string_method(methods: StringMethods, owner: Value, name: str) -> Value | None:
    """Return a method of a string, bound to it."""
    call: Any = methods.get(name)
    return LibraryFunction(name, call, owner) if call is not None else None
