"""Methods of strings, in both languages, on strings that may have holes."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from string import Formatter
from typing import Any

from rtron.sources.code.interpreter.abstract_values.elements import element
from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    Native,
    Text,
    Value,
    concat,
    is_tainted,
    parts_of,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments

MAX_LENGTH = 4096
MAX_LONG = 2**20
"""The most that a method leaves of a text longer than that, as the description of a robot is."""
_PER_STEP = 64
"""As many characters of a long text take a step."""
_PLAIN = [
    "strip",
    "lstrip",
    "rstrip",
    "lower",
    "upper",
    "title",
    "capitalize",
    "swapcase",
    "replace",
    "startswith",
    "endswith",
    "find",
    "rfind",
    "index",
    "count",
    "isdigit",
    "isalpha",
    "isalnum",
    "isupper",
    "islower",
    "zfill",
]

_PER_PART = frozenset({"lower", "upper", "replace", "swapcase"})
_ENDS = frozenset({"strip", "lstrip", "rstrip"})


def _plain(name: str, machine: Machine, owner: Value, arguments: Arguments) -> Value:
    values = arguments.values
    if not all(isinstance(value, Known) for value in values):
        return owner if name in {"strip", "lstrip", "rstrip"} else Hole(name, is_tainted(owner))
    if isinstance(owner, Text):
        return _plain_in_part(name, owner, [value.value for value in values])  # type: ignore[union-attr]
    if not isinstance(owner, Known):
        return owner if name in {*_PER_PART, *_ENDS} else Hole(name, is_tainted(owner))
    try:
        found = _called(machine, name, owner.value, [value.value for value in values])  # type: ignore[union-attr]
    except (TypeError, ValueError, AttributeError):
        return Hole(name)
    return Known(found, owner.tainted)


def _called(machine: Machine, name: str, text: Any, values: list[Any]) -> Any:  # noqa: ANN401 - any Python values
    """Return what a method gives; raise ValueError where that may be too long."""
    most = _most(name, text, values)
    if most > (MAX_LENGTH if len(text) <= MAX_LENGTH else MAX_LONG):
        raise ValueError(f"more than {MAX_LENGTH} characters")
    machine.work(most // _PER_STEP)
    return getattr(text, name)(*values)


def _most(name: str, text: str, values: list[Any]) -> int:
    """Return how many characters a method leaves at most; case changes only in their places."""
    if name == "replace":
        old, new = values[:2]
        return len(text) + text.count(old) * max(0, len(new) - len(old))
    return max(len(text), *values) if name == "zfill" else len(text)


def _plain_in_part(name: str, owner: Text, values: list[Any]) -> Value:
    """Do to the known parts of a string what its method does to the whole."""
    if name in {"startswith", "endswith"}:
        return _decided_at_end(name, owner, values)
    last = len(owner.parts) - 1
    touched = {"lstrip": {0}, "rstrip": {last}, "strip": {0, last}}.get(name, range(last + 1))
    if name not in _PER_PART and name not in _ENDS:
        return Hole(name, owner.tainted)
    method = {(0, "strip"): "lstrip", (last, "strip"): "rstrip"}
    try:
        parts = [
            getattr(part, method.get((at, name), name))(*values)
            if isinstance(part, str) and at in touched
            else part
            for at, part in enumerate(owner.parts)
        ]
    except (TypeError, ValueError):
        return Hole(name, owner.tainted)
    return concat(
        [part if isinstance(part, Hole) else Known(part, owner.tainted) for part in parts]
    )


def _decided_at_end(name: str, owner: Text, values: list[Any]) -> Value:
    part = owner.parts[0 if name == "startswith" else -1]
    wanted = values[0] if values else None
    if isinstance(part, str) and isinstance(wanted, str) and len(part) >= len(wanted):
        return Known(getattr(part, name)(wanted), owner.tainted)
    return Hole(name, owner.tainted)


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


def _lines(_: Machine, owner: Value, __: Arguments) -> Value:
    if not isinstance(owner, Known):
        return Hole("splitlines", is_tainted(owner))
    return listed([Known(line, owner.tainted) for line in str(owner.value).splitlines()])


def _recoded(_: Machine, owner: Value, arguments: Arguments) -> Value:
    """Text and bytes are one here; what `errors` leaves out is not known."""
    plain = isinstance(owner, Known) and str(owner.value).isascii()
    return owner if plain or not arguments.get(1, "errors") else Hole("encode", is_tainted(owner))


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


def _format(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`"…".format(…)`: fields by place and name, with attributes and elements."""
    parts: list[Value] = []
    for part in parts_of(owner):
        if isinstance(part, Hole):
            parts.append(part)
        else:
            parts.extend(_fields(machine, part, arguments))
    return concat(parts)


def _fields(machine: Machine, text: str, arguments: Arguments) -> list[Value]:
    parts: list[Value] = []
    try:
        pieces = list(Formatter().parse(text))
    except ValueError:
        return [Hole("format")]
    place = 0
    for before, name, spec, _ in pieces:
        parts.append(Known(before))
        if name is not None:
            is_next = not name or name[0] in ".["
            value = _field(machine, f"{place}{name}" if is_next else name, arguments)
            parts.append(_specified(value, spec or ""))
            place += is_next
    return parts


def _field(machine: Machine, name: str, arguments: Arguments) -> Value:
    key = re.split(r"[.\[]", name, maxsplit=1)[0]
    value = arguments.get(int(key)) if key.isdigit() else arguments.keywords.get(key)
    for attribute, item in re.findall(r"\.(\w+)|\[([^\]]*)\]", name[len(key) :]):
        if value is None:
            break
        if attribute:
            value = machine.world.attribute(value, attribute, ())
        else:
            value = element(value, Known(int(item) if item.isdigit() else item))
    return Hole(name) if value is None else value


def _specified(value: Value, spec: str) -> Value:
    if spec and isinstance(value, Known) and len(spec) < 8:  # noqa: PLR2004
        try:
            return Known(format(value.value, spec), value.tainted)
        except (TypeError, ValueError):
            return Hole(spec, value.tainted)
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
    if not all(isinstance(number, int) for number in numbers):
        return Hole("substr")
    start = numbers[0] if numbers else 0
    end = start + numbers[1] if len(numbers) > 1 else None
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
    "encode": _recoded,
    "decode": _recoded,
    "splitlines": _lines,
}


def _bounds(name: str, _: Machine, owner: Value, arguments: Arguments) -> Value:
    """`text.starts_with(part)`, `text.ends_with(part)`."""
    part = arguments.get(0)
    if isinstance(owner, Known) and isinstance(part, Known) and isinstance(part.value, str):
        text = str(owner.value)
        found = text.startswith(part.value) if name == "starts_with" else text.endswith(part.value)
        return Known(found, owner.tainted)
    return Hole(name)


CPP_TEXT: Methods = {
    **dict.fromkeys(("c_str", "data", "str", "toStdString", "toUtf8", "constData"), _same),
    **dict.fromkeys(("string", "generic_string"), _same),
    **{name: partial(_bounds, name) for name in ("starts_with", "ends_with")},
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
