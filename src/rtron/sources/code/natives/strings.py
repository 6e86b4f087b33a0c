"""Methods of strings, in both languages, on strings that may have holes."""

from collections.abc import Callable, Mapping
from functools import partial
from string import Formatter
from typing import Any

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.items import items_of, listed
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.values import (
    Hole,
    Known,
    Native,
    Text,
    Value,
    concat,
    is_tainted,
    parts_of,
)

MAX_LENGTH = 4096
_PLAIN = (
    "strip lstrip rstrip lower upper title capitalize swapcase replace startswith endswith find "
    "rfind index count isdigit isalpha isalnum isupper islower zfill"
).split()


def _plain(name: str, _: Machine, owner: Value, arguments: Arguments) -> Value:
    values = arguments.values
    if not isinstance(owner, Known) or not all(isinstance(value, Known) for value in values):
        return owner if name in {"strip", "lstrip", "rstrip", "lower"} else Hole(name)
    try:
        found = getattr(owner.value, name)(*(value.value for value in values))  # type: ignore[union-attr]
    except (TypeError, ValueError, AttributeError):
        return Hole(name)
    return Known(found, owner.tainted) if len(str(found)) <= MAX_LENGTH else Hole(name)


def _split(name: str, _: Machine, owner: Value, arguments: Arguments) -> Value:
    separator = arguments.get(0, "sep")
    if not isinstance(owner, Known) or isinstance(separator, (Hole, Text)):
        return Hole(name)
    given = separator.value if isinstance(separator, Known) else None
    limit = arguments.get(1, "maxsplit")
    most = limit.value if isinstance(limit, Known) and isinstance(limit.value, int) else -1
    try:
        pieces = getattr(str(owner.value), name)(given or None, most)
    except (TypeError, ValueError):
        return Hole(name)
    return listed([Known(piece, owner.tainted) for piece in pieces])


def _partition(name: str, _: Machine, owner: Value, arguments: Arguments) -> Value:
    separator = arguments.get(0)
    if isinstance(owner, Known) and isinstance(separator, Known) and separator.value:
        pieces = getattr(str(owner.value), name)(str(separator.value))
        return listed([Known(piece, owner.tainted) for piece in pieces], "tuple")
    return Hole(name)


def _join(_: Machine, owner: Value, arguments: Arguments) -> Value:
    items, certain = items_of(arguments.get(0) or Hole("?"))
    if not certain:
        return Hole("join")
    spread = [part for item in items for part in (owner, item)]
    return concat(spread[1:])


def _format(_: Machine, owner: Value, arguments: Arguments) -> Value:
    """`"…".format(…)`: fields by place and name; attributes and specs are left out of account."""
    parts: list[Value] = []
    for part in parts_of(owner):
        if isinstance(part, Hole):
            parts.append(part)
        else:
            parts.extend(_fields(part, arguments))
    return concat(parts)


def _fields(text: str, arguments: Arguments) -> list[Value]:
    parts: list[Value] = []
    try:
        pieces = list(Formatter().parse(text))
    except ValueError:
        return [Hole("format")]
    for place, (before, name, spec, _) in enumerate(pieces):
        parts.append(Known(before))
        if name is not None:
            parts.append(_field(name or str(place), spec or "", arguments))
    return parts


def _field(name: str, spec: str, arguments: Arguments) -> Value:
    key = name.split(".", maxsplit=1)[0].split("[", maxsplit=1)[0]
    value = arguments.get(int(key)) if key.isdigit() else arguments.keywords.get(key)
    if value is None or key != name:
        return Hole(name)
    if spec and isinstance(value, Known) and len(spec) < 8:  # noqa: PLR2004
        try:
            return Known(format(value.value, spec), value.tainted)
        except (TypeError, ValueError):
            return Hole(name)
    return value


def _same(_: Machine, owner: Value, __: Arguments) -> Value:
    return owner


def _length(_: Machine, owner: Value, __: Arguments) -> Value:
    return Known(len(str(owner.value)), owner.tainted) if isinstance(owner, Known) else Hole("size")


def _empty(_: Machine, owner: Value, __: Arguments) -> Value:
    if isinstance(owner, Known):
        return Known(not owner.value, owner.tainted)
    sure = isinstance(owner, Text) and any(isinstance(part, str) and part for part in owner.parts)
    return Known(value=False) if sure else Hole("empty", is_tainted(owner))


def _substr(_: Machine, owner: Value, arguments: Arguments) -> Value:
    numbers = [value.value for value in arguments.values if isinstance(value, Known)]
    if not isinstance(owner, Known) or len(numbers) != len(arguments.values):
        return Hole("substr")
    start = int(numbers[0]) if numbers else 0
    end = start + int(numbers[1]) if len(numbers) > 1 else None
    return Known(str(owner.value)[start:end], owner.tainted)


def _find(name: str, _: Machine, owner: Value, arguments: Arguments) -> Value:
    wanted = arguments.get(0)
    if not (isinstance(owner, Known) and isinstance(wanted, Known)):
        return Hole(name)
    return Known(getattr(str(owner.value), name)(str(wanted.value)))


def _compare(_: Machine, owner: Value, arguments: Arguments) -> Value:
    other = arguments.get(0)
    if not (isinstance(owner, Known) and isinstance(other, Known)):
        return Hole("compare")
    left, right = str(owner.value), str(other.value)
    return Known((left > right) - (left < right), owner.tainted)


def _at(_: Machine, owner: Value, arguments: Arguments) -> Value:
    place = arguments.get(0) or Known(0)
    if isinstance(owner, Known) and isinstance(place, Known) and owner.value:
        text = str(owner.value)
        if isinstance(place.value, int) and -len(text) <= place.value < len(text):
            return Known(text[place.value], owner.tainted)
    return Hole("at")


Methods = Mapping[str, Callable[..., Value]]

PYTHON_TEXT: Methods = {
    **{name: partial(_plain, name) for name in _PLAIN},
    **{name: partial(_split, name) for name in ("split", "rsplit")},
    **{name: partial(_partition, name) for name in ("partition", "rpartition")},
    "join": _join,
    "format": _format,
    "encode": _same,
    "decode": _same,
    "splitlines": lambda machine, owner, arguments: _split("split", machine, owner, arguments),
}
CPP_TEXT: Methods = {
    **dict.fromkeys(("c_str", "data", "str", "toStdString", "toUtf8", "constData"), _same),
    **dict.fromkeys(("size", "length"), _length),
    "empty": _empty,
    "substr": _substr,
    "find": partial(_find, "find"),
    "rfind": partial(_find, "rfind"),
    "compare": _compare,
    "at": _at,
    "front": _at,
    "back": lambda machine, owner, arguments: _at(
        machine, owner, Arguments(values=(Known(-1),), frame=arguments.frame)
    ),
}


def text_method(methods: Methods, owner: Value, name: str) -> Value | None:
    """Return a method of a string, bound to it."""
    call: Any = methods.get(name)
    return Native(name, call, owner) if call is not None else None
