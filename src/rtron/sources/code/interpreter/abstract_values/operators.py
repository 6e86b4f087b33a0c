"""Operators on values that may be known in part only."""

import operator
from collections.abc import Callable, Mapping
from typing import Any

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Choice,
    Foreign,
    Hole,
    Known,
    ListValue,
    MapValue,
    Text,
    Value,
    concat,
    is_tainted,
    join,
    options,
    parts_of,
)

MAX_LENGTH = 4096
MAX_BITS = 256

_ARITHMETIC: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    ">>": operator.rshift,
}
_COMPARISONS: Mapping[str, Callable[[Any, Any], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "is": operator.eq,
    "is not": operator.ne,
}


def binary(name: str, left: Value, right: Value) -> Value:
    """Return `left name right` over every option of both."""
    if not isinstance(left, Choice) and not isinstance(right, Choice):
        return _binary(name, left, right)
    pairs = [(one, other) for one in options(left) for other in options(right)]
    return join([_binary(name, *pair) for pair in pairs[: 2 * 24]])


def _binary(name: str, left: Value, right: Value) -> Value:
    if name in {"in", "not in"}:
        return _membership(name, left, right)
    if name in _COMPARISONS:
        return _compared(name, left, right)
    if name == "%" and _is_text(left):
        return percent(left, right)
    if name == "+":
        return _added(left, right)
    if name == "*" and isinstance(left, ListValue):
        return _repeated(left, right)
    return _arithmetic(name, left, right)


def _added(left: Value, right: Value) -> Value:
    if isinstance(left, ListValue) and isinstance(right, ListValue):
        items = left.items + right.items
        cut = len(items) > MAX_LENGTH
        both = {"items": items[:MAX_LENGTH], "open": left.open or right.open or cut}
        return ListValue(both, left.kind)
    if _is_text(left) or _is_text(right):
        return concat((left, right))
    return _arithmetic("+", left, right)


def _arithmetic(name: str, left: Value, right: Value) -> Value:
    tainted = is_tainted(left) or is_tainted(right)
    if not (isinstance(left, Known) and isinstance(right, Known)) or name not in _ARITHMETIC:
        return Hole(_hole_name(left, right), tainted)
    try:
        if name == "*" and not _small(left.value, right.value):
            return Hole("large", tainted)
        return Known(_bounded(_ARITHMETIC[name](left.value, right.value)), tainted)
    except TypeError:
        is_path = name == "/" and _is_text(left) and _is_text(right)
        return concat((left, Known("/"), right)) if is_path else Hole("?", tainted)
    except (ArithmeticError, ValueError):
        return Hole("?", tainted)


def _small(left: Any, right: Any) -> bool:  # noqa: ANN401 - any Python values
    for text, times in ((left, right), (right, left)):
        if isinstance(text, (str, bytes)) and isinstance(times, int):
            return len(text) * times <= MAX_LENGTH
    return True


def _bounded(value: Any) -> Any:  # noqa: ANN401 - any Python value
    if isinstance(value, int) and value.bit_length() > MAX_BITS:
        raise ValueError("large")
    if isinstance(value, str) and len(value) > MAX_LENGTH:
        raise ValueError("long")
    return value


def _compared(name: str, left: Value, right: Value) -> Value:
    if left is right and not isinstance(left, (Hole, Foreign, Text)):
        return Known(name in {"==", "is", "<=", ">="})
    if isinstance(left, Known) and isinstance(right, Known):
        try:
            answer = _COMPARISONS[name](left.value, right.value)
        except TypeError:
            return Hole("comparison")
        return Known(answer, left.tainted or right.tainted)
    if isinstance(left, ListValue) and isinstance(right, ListValue):
        return Hole("comparison")
    if _undecidable(left) or _undecidable(right):
        return Hole("comparison")
    return Known(name in {"!=", "is not"})


def _undecidable(value: Value) -> bool:
    return isinstance(value, (Hole, Foreign, Text))


def _membership(name: str, item: Value, container: Value) -> Value:
    found = _contains(item, container)
    return Hole("in") if found is None else Known(found is (name == "in"))


def _contains(item: Value, container: Value) -> bool | None:
    if not isinstance(item, Known):
        return None
    if isinstance(container, Known) and isinstance(container.value, str):
        return str(item.value) in container.value
    if isinstance(container, MapValue):
        return True if item.value in container.entries else (None if container.open else False)
    if isinstance(container, ListValue):
        return _among(item, container)
    return None


def _among(item: Known, container: ListValue) -> bool | None:
    answers = [_compared("==", item, option) for option in container.items]
    if any(isinstance(answer, Known) and answer.value for answer in answers):
        return True
    unsure = container.open or any(isinstance(answer, Hole) for answer in answers)
    return None if unsure else False


def _repeated(items: ListValue, times: Value) -> Value:
    if isinstance(times, Known) and isinstance(times.value, int):
        count = max(0, min(times.value, MAX_LENGTH // max(1, len(items.items))))
        return ListValue({"items": items.items * count}, items.kind)
    return ListValue({"items": items.items, "open": True}, items.kind)


def _is_text(value: Value) -> bool:
    return isinstance(value, Text) or (isinstance(value, Known) and isinstance(value.value, str))


def _hole_name(left: Value, right: Value) -> str:
    holes = [
        part.why for side in (left, right) for part in parts_of(side) if isinstance(part, Hole)
    ]
    return holes[0] if holes else "?"


def percent(template: Value, given: Value) -> Value:
    """Return `template % given`, holes and all (Python: printf-style formatting)."""
    values: list[Value] = list(given.items) if isinstance(given, ListValue) else [given]
    mapping = given.entries if isinstance(given, MapValue) else {}
    parts: list[Value] = []
    for part in parts_of(template):
        parts.extend(_formatted(part, values, mapping) if isinstance(part, str) else [part])
    return concat(parts)


def _formatted(text: str, values: list[Value], mapping: Mapping[Any, Value]) -> list[Value]:
    parts: list[Value] = []
    rest = text
    while "%" in rest:
        before, _, after = rest.partition("%")
        parts.append(Known(before))
        part, rest = _one(after, values, mapping)
        parts.append(part)
    return [*parts, Known(rest)]


def _one(after: str, values: list[Value], mapping: Mapping[Any, Value]) -> tuple[Value, str]:
    """Return what one conversion puts in, and the text behind it; `after` begins behind the %."""
    name, rest = None, after
    if after.startswith("("):
        name, _, rest = after[1:].partition(")")
    flags = len(rest) - len(rest.lstrip("#0- +.123456789lh"))
    spec, kind, rest = rest[:flags], rest[flags : flags + 1], rest[flags + 1 :]
    if kind == "%":
        return Known("%"), rest
    value = mapping.get(name, Hole(name)) if name else (values.pop(0) if values else Hole("?"))
    return _shown(spec + kind, value), rest


def _shown(spec: str, value: Value) -> Value:
    if isinstance(value, Known) and spec != "s" and len(spec) < 8:  # noqa: PLR2004
        try:
            shown = ("%" + spec.replace("l", "")) % value.value
            return Known(_bounded(shown), value.tainted)
        except (TypeError, ValueError):
            return value
    return value


def unary(name: str, operand: Value) -> Value:
    """Return `-x`, `+x` or `~x`."""
    if isinstance(operand, Choice):
        return join([unary(name, option) for option in operand.options])
    if isinstance(operand, Known) and isinstance(operand.value, (int, float)):
        value = operand.value
        if name == "-":
            return Known(-value, operand.tainted)
        if name == "+":
            return operand
    return Hole("?", is_tainted(operand))
