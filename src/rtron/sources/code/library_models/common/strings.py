"""Methods of strings, in both languages, on strings that may be known in part."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from string import Formatter
from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
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
    name: str, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    values = arguments.values
    if not all(isinstance(value, av.Scalar) for value in values):
        return owner if name in _STRIP_METHODS else av.Unknown(name, av.is_tainted(owner))
    if isinstance(owner, av.PartialText):
        return _call_on_parts(name, owner, [value.value for value in values])  # type: ignore[union-attr]
    if not isinstance(owner, av.Scalar):
        keeps_owner = name in _PARTWISE_METHODS | _STRIP_METHODS
        return owner if keeps_owner else av.Unknown(name, av.is_tainted(owner))
    try:
        found = _call_bounded(machine, name, owner.value, [value.value for value in values])  # type: ignore[union-attr]
    except (TypeError, ValueError, AttributeError):
        return av.Unknown(name)
    return av.Scalar(found, owner.tainted)


def _call_bounded(machine: AbstractMachine, name: str, text: Any, values: list[Any]) -> Any:  # noqa: ANN401 - any Python values
    """Return what a method gives; raise ValueError where that may be too long."""
    most = _max_result_length(name, text, values)
    if most > (av.MAX_LENGTH if len(text) <= av.MAX_LENGTH else MAX_LONG_LENGTH):
        raise ValueError(f"more than {av.MAX_LENGTH} characters")
    machine.count_steps(most // _CHARACTERS_PER_STEP)
    return getattr(text, name)(*values)


def _max_result_length(name: str, text: str, values: list[Any]) -> int:
    """Return how many characters a method leaves at most; case changes only where they are."""
    if name == "replace":
        old, new = values[:2]
        return len(text) + text.count(old) * max(0, len(new) - len(old))
    return max(len(text), *values[:1]) if name in _PADDING_METHODS else len(text)


def _call_on_parts(name: str, owner: av.PartialText, values: list[Any]) -> av.Value:
    """Do to the known parts of a string what its method does to the whole."""
    if name in {"startswith", "endswith"}:
        return _starts_or_ends_with(name, owner, values)
    last = len(owner.parts) - 1
    touched = {"lstrip": {0}, "rstrip": {last}, "strip": {0, last}}.get(name, range(last + 1))
    if name not in _PARTWISE_METHODS and name not in _STRIP_METHODS:
        return av.Unknown(name, owner.tainted)
    method = {(0, "strip"): "lstrip", (last, "strip"): "rstrip"}
    try:
        parts = [
            getattr(part, method.get((at, name), name))(*values)
            if isinstance(part, str) and at in touched
            else part
            for at, part in enumerate(owner.parts)
        ]
    except (TypeError, ValueError):
        return av.Unknown(name, owner.tainted)
    return av.concat(
        [part if isinstance(part, av.Unknown) else av.Scalar(part, owner.tainted) for part in parts]
    )


def _starts_or_ends_with(name: str, owner: av.PartialText, values: list[Any]) -> av.Value:
    part = owner.parts[0 if name == "startswith" else -1]
    affix = values[0] if values else None
    if isinstance(part, str) and isinstance(affix, str) and len(part) >= len(affix):
        return av.Scalar(getattr(part, name)(affix), owner.tainted)
    return av.Unknown(name, owner.tainted)


def _split(name: str, _: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    separator = arguments.get(0, "sep")
    if not isinstance(owner, av.Scalar) or isinstance(separator, (av.Unknown, av.PartialText)):
        return av.Unknown(name)
    given = separator.value if isinstance(separator, av.Scalar) else None
    limit = arguments.get(1, "maxsplit")
    most = limit.value if isinstance(limit, av.Scalar) and isinstance(limit.value, int) else -1
    try:
        pieces = getattr(str(owner.value), name)(given or None, most)
    except (TypeError, ValueError):
        return av.Unknown(name)
    return av.list_of([av.Scalar(piece, owner.tainted) for piece in pieces])


def _splitlines(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    if not isinstance(owner, av.Scalar):
        return av.Unknown("splitlines", av.is_tainted(owner))
    return av.list_of([av.Scalar(line, owner.tainted) for line in str(owner.value).splitlines()])


def _encode_or_decode(_: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """Text and bytes are one here; what `errors` leaves out is not known."""
    plain = isinstance(owner, av.Scalar) and str(owner.value).isascii()
    known = plain or not arguments.get(1, "errors")
    return owner if known else av.Unknown("encode", av.is_tainted(owner))


def _partition(name: str, _: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    separator = arguments.get(0)
    if isinstance(owner, av.Scalar) and isinstance(separator, av.Scalar) and separator.value:
        pieces = getattr(str(owner.value), name)(str(separator.value))
        return av.list_of([av.Scalar(piece, owner.tainted) for piece in pieces], "tuple")
    return av.Unknown(name)


def _join(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    items, certain = machine.runtime.iterate(arguments.value(0))
    if not certain:
        return av.Unknown("join")
    spread = [part for item in items for part in (owner, item)]
    return av.concat(spread[1:])


def fill_fields(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`"…".format(…)`: fields by position and name, with attributes and elements."""
    parts: list[av.Value] = []
    for part in av.parts_of(owner):
        if isinstance(part, av.Unknown):
            parts.append(part)
        else:
            parts.extend(_format_fields(machine, part, arguments))
    return av.concat(parts)


def _format_fields(machine: AbstractMachine, text: str, arguments: Arguments) -> list[av.Value]:
    parts: list[av.Value] = []
    try:
        pieces = list(Formatter().parse(text))
    except ValueError:
        return [av.Unknown("format")]
    index = 0
    for before, name, spec, conversion in pieces:
        parts.append(av.Scalar(before))
        if name is not None:
            is_next = not name or name[0] in ".["
            value = _format_field(machine, f"{index}{name}" if is_next else name, arguments)
            is_repr = conversion in {"r", "a"}
            value = av.repr_of(value) if is_repr else machine.runtime.shown(value)
            index += is_next
            later = arguments.values[index if is_next else 0 :]
            written = _format_spec(machine, spec or "", replace(arguments, values=later))
            parts.append(apply_format_spec(value, written))
    return parts


def _format_spec(machine: AbstractMachine, spec: str, arguments: Arguments) -> str:
    """Return a format with the fields in it put in: `0{}d`."""
    if "{" not in spec:
        return spec
    return av.text_with_holes(av.concat(_format_fields(machine, spec, arguments)))


def _format_field(machine: AbstractMachine, name: str, arguments: Arguments) -> av.Value:
    key = re.split(r"[.\[]", name, maxsplit=1)[0]
    value = arguments.get(int(key)) if key.isdigit() else arguments.keywords.get(key)
    for attribute, item in re.findall(r"\.(\w+)|\[([^\]]*)\]", name[len(key) :]):
        if value is None:
            break
        if attribute:
            value = machine.runtime.attribute(value, attribute, ())
        else:
            value = av.element(value, av.Scalar(int(item) if item.isdigit() else item))
    return av.Unknown(name) if value is None else value


def apply_format_spec(value: av.Value, spec: str) -> av.Value:
    """Return a value as `format(value, spec)` shows it; as it is where it is not known."""
    if spec and isinstance(value, av.Scalar) and len(spec) < 8:  # noqa: PLR2004
        try:
            return av.Scalar(format(value.value, spec), value.tainted)
        except (TypeError, ValueError):
            return av.Unknown(spec, value.tainted)
    return value


def _empty(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    if isinstance(owner, av.Scalar):
        return av.Scalar(not owner.value, owner.tainted)
    sure = isinstance(owner, av.PartialText) and any(
        isinstance(part, str) and part for part in owner.parts
    )
    return av.Scalar(value=False) if sure else av.Unknown("empty", av.is_tainted(owner))


def _call_on_known(
    label: str,
    function: Callable[..., object],
    _: AbstractMachine,
    owner: av.Value,
    arguments: Arguments,
) -> av.Value:
    """Return what a function makes of a text and arguments that are all known."""
    given = [value.value for value in arguments.values if isinstance(value, av.Scalar)]
    if not isinstance(owner, av.Scalar) or len(given) != len(arguments.values):
        return av.Unknown(label)
    try:
        return av.Scalar(function(str(owner.value), *given), owner.tainted)
    except (TypeError, ValueError, IndexError):
        return av.Unknown(label)


def _substr(text: str, start: int = 0, count: int = -1) -> str:
    return text[start:] if count < 0 else text[start : start + count]


def compare(left: str, right: str) -> int:
    """Return what `strcmp` does: 0 where two texts are alike."""
    return (left > right) - (left < right)


StringMethods = Mapping[str, Callable[..., av.Value]]

PYTHON_STRING_METHODS: StringMethods = {
    **{name: partial(_call_str_method, name) for name in _STR_METHODS},
    **{name: partial(_split, name) for name in ("split", "rsplit")},
    **{name: partial(_partition, name) for name in ("partition", "rpartition")},
    "join": _join,
    "format": fill_fields,
    "encode": _encode_or_decode,
    "decode": _encode_or_decode,
    "splitlines": _splitlines,
}


_CPP_METHODS: Mapping[str, Callable[..., object]] = {
    **dict.fromkeys(("size", "length"), len),
    "substr": _substr,
    "find": str.find,
    "rfind": str.rfind,
    "compare": compare,
    "at": str.__getitem__,
    "front": lambda text: text[0],
    "back": lambda text: text[-1],
    "starts_with": str.startswith,
    "ends_with": str.endswith,
}
CPP_STRING_METHODS: StringMethods = {
    **dict.fromkeys(("c_str", "data", "str", "toStdString", "toUtf8", "constData"), return_owner),
    **dict.fromkeys(("string", "generic_string"), return_owner),
    **{name: partial(_call_on_known, name, call) for name, call in _CPP_METHODS.items()},
    "empty": _empty,
}


def bound_string_method(methods: StringMethods, owner: av.Value, name: str) -> av.Value | None:
    """Return a method of a string, bound to it."""
    call: Any = methods.get(name)
    return av.LibraryFunction(name, call, owner) if call is not None else None
