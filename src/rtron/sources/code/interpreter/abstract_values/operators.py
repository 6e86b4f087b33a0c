"""Operators on values that may be known in part only."""

import operator
from collections.abc import Callable, Mapping
from typing import Any, TypeGuard

from rtron.sources.code.interpreter.abstract_values.items import is_record, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    MAX_CHOICES,
    MAX_LENGTH,
    OPEN,
    UNKNOWN,
    Choice,
    ClassValue,
    ExternalSymbol,
    FunctionValue,
    Instance,
    LibraryFunction,
    ListValue,
    MapValue,
    MessageType,
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    is_text,
    join,
    options,
    parts_of,
)

MAX_BITS = 256
MAX_PAIRS = 2 * MAX_CHOICES


_ARITHMETIC: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "**": operator.pow,
    "<<": operator.lshift,
    "%": operator.mod,
    "&": operator.and_,
    "|": operator.or_,
    "^": operator.xor,
    ">>": operator.rshift,
}
_KINDS: Mapping[str, Callable[[list[Any]], Any]] = {"tuple": tuple, "set": frozenset}
_MAX_DEPTH = 8
_COMPARED = (MessageType, LibraryFunction)
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


ARRAY = "ndarray"
"""The kind of a list that is an array of numpy."""
_SETS: Mapping[str, Callable[[Any, Any], Any]] = {
    "|": operator.or_,
    "&": operator.and_,
    "-": lambda one, other: one and not other,
    "^": operator.ne,
}


def binary(name: str, left: Value, right: Value) -> Value:
    """Return `left name right` over every option of both."""
    if name not in {"in", "not in"} and (_is_array(left) or _is_array(right)):
        return Unknown("array")
    if not isinstance(left, Choice) and not isinstance(right, Choice):
        return _binary(name, left, right)
    pairs = [(one, other) for one in options(left) for other in options(right)]
    if len(pairs) > MAX_PAIRS:
        return Unknown("many", is_tainted(left) or is_tainted(right))
    return join([_binary(name, *pair) for pair in pairs])


def cpp_binary(name: str, left: Value, right: Value) -> Value:
    """Return `left name right` as C++ does: whole quotients, and the distance of two letters."""
    if isinstance(left, Scalar) and isinstance(right, Scalar):
        values = (left.value, right.value)
        if name == "/" and all(isinstance(value, int) for value in values):
            return binary("//", left, right)
        if name == "-" and all(isinstance(each, str) and len(each) == 1 for each in values):
            return Scalar(ord(str(left.value)) - ord(str(right.value)), left.tainted)
    return binary(name, left, right)


def _binary(name: str, left: Value, right: Value) -> Value:
    if name in {"in", "not in"}:
        return _membership(name, left, right)
    if name in _COMPARISONS:
        return _compare(name, left, right)
    if name == "%" and is_text(left):
        return percent_format(left, right)
    if name == "+":
        return _add(left, right)
    if isinstance(left, (ListValue, MapValue)):
        return _combine_containers(name, left, right)
    return _arithmetic(name, left, right)


def _combine_containers(name: str, left: ListValue | MapValue, right: Value) -> Value:
    if isinstance(left, MapValue):
        if isinstance(right, MapValue) and name == "|":
            return MapValue({**left.fields, **right.fields})
        return _arithmetic(name, left, right)
    if name == "*":
        return _repeat(left, right)
    if name in _SETS and is_set(left) and isinstance(right, ListValue):
        return _combine_sets(name, left, right)
    return _arithmetic(name, left, right)


def _is_array(value: Value) -> bool:
    """Tell whether a value is an array of numpy, of which each item is computed by itself."""
    return isinstance(value, ListValue) and value.kind == ARRAY


def is_set(value: Value) -> TypeGuard[ListValue]:
    """Tell whether a value is a set."""
    return isinstance(value, ListValue) and value.kind == "set"


def _combine_sets(name: str, left: ListValue, right: ListValue) -> Value:
    """Return `a | b`, `a & b`, `a - b` or `a ^ b`; where that is not known, all they hold."""
    items = (*left.items, *(item for item in right.items if item not in left.items))
    answers = [(_contains(item, left), _contains(item, right)) for item in items]
    if any(side is None for sides in answers for side in sides):
        return ListValue({"items": items, "open": True}, left.kind)
    chosen = [item for item, sides in zip(items, answers, strict=True) if _SETS[name](*sides)]
    return ListValue({"items": tuple(chosen), "open": False}, left.kind)


def _add(left: Value, right: Value) -> Value:
    if isinstance(left, ListValue) and isinstance(right, ListValue):
        items = left.items + right.items
        cut = len(items) > MAX_LENGTH
        both = {"items": items[:MAX_LENGTH], "open": left.open or right.open or cut}
        return ListValue(both, left.kind)
    if is_text(left) or is_text(right):
        return concat((left, right))
    return _arithmetic("+", left, right)


def _arithmetic(name: str, left: Value, right: Value) -> Value:
    tainted = is_tainted(left) or is_tainted(right)
    if not (isinstance(left, Scalar) and isinstance(right, Scalar)) or name not in _ARITHMETIC:
        return Unknown(_hole_name(left, right), tainted)
    try:
        if name == "*" and not _is_short_repetition(left.value, right.value):
            return Unknown("large", tainted)
        if name in {"**", "<<"} and not (_is_small(left.value) and _is_small(right.value)):
            return Unknown("large", tainted)
        return Scalar(_check_size(_ARITHMETIC[name](left.value, right.value)), tainted)
    except TypeError:
        is_path = name == "/" and is_text(left) and is_text(right)
        return concat((left, Scalar("/"), right)) if is_path else Unknown("?", tainted)
    except (ArithmeticError, ValueError):
        return Unknown("?", tainted)


def _is_small(value: Any) -> bool:  # noqa: ANN401 - any Python value
    return isinstance(value, (int, float)) and abs(value) < MAX_BITS


def _is_short_repetition(left: Any, right: Any) -> bool:  # noqa: ANN401 - any Python values
    for text, times in ((left, right), (right, left)):
        if isinstance(text, (str, bytes)) and isinstance(times, int):
            return len(text) * times <= MAX_LENGTH
    return True


def _check_size(value: Any) -> Any:  # noqa: ANN401 - any Python value
    if isinstance(value, int) and value.bit_length() > MAX_BITS:
        raise ValueError("large")
    if isinstance(value, str) and len(value) > MAX_LENGTH:
        raise ValueError("long")
    return value


def _compare(name: str, left: Value, right: Value) -> Value:
    is_same = left is right or (isinstance(left, _COMPARED) and left == right)
    if is_same and not _is_undecidable(left):
        return Scalar(name in {"==", "is", "<=", ">="})
    if isinstance(left, Scalar) and isinstance(right, Scalar):
        try:
            answer = _COMPARISONS[name](left.value, right.value)
        except TypeError:
            return Unknown("comparison")
        return Scalar(answer, left.tainted or right.tainted)
    if isinstance(left, (ListValue, MapValue)) and type(left) is type(right):
        return _compare_containers(name, left, right)
    may_be_equal = type(left) is type(right) and _compares_itself(left)
    if may_be_equal or _is_undecidable(left) or _is_undecidable(right):
        return Unknown("comparison")
    return Scalar(name in {"!=", "is not"})


def _compare_containers(name: str, left: Value, right: Value) -> Value:
    """Compare lists or dicts of numbers and texts; which of others are equal is not known."""
    try:
        is_same = _plain(left, _MAX_DEPTH) == _plain(right, _MAX_DEPTH)
    except ValueError:
        return Unknown("comparison")
    return Scalar(is_same is (name == "==")) if name in {"==", "!="} else Unknown("comparison")


def _plain(value: Value, depth: int) -> Any:  # noqa: ANN401 - any Python value
    """Return the Python value that a value is; a ValueError for one that is not known whole."""
    if isinstance(value, Scalar):
        return value.value
    if depth and isinstance(value, ListValue) and not value.open:
        items = [_plain(item, depth - 1) for item in value.items]
        return _KINDS.get(value.kind, list)(items)
    if depth and isinstance(value, MapValue) and not value.open:
        return {key: _plain(entry, depth - 1) for key, entry in value.fields.items()}
    raise ValueError(value)


def _compares_itself(value: Value) -> bool:
    """Tell whether equal values may be different objects: records, bound methods."""
    if isinstance(value, Instance) and isinstance(value.type, ClassValue):
        return not {"__eq__", "__fields__"}.isdisjoint(value.type.fields)
    return isinstance(value, FunctionValue) or is_record(getattr(value, "type", None))


def _is_undecidable(value: Value) -> bool:
    return isinstance(value, (Unknown, ExternalSymbol, PartialText))


def _membership(name: str, item: Value, container: Value) -> Value:
    found = _contains(item, container)
    return Unknown("in") if found is None else Scalar(found is (name == "in"))


def _contains(item: Value, container: Value) -> bool | None:
    if isinstance(container, MapValue):
        return _is_key(container.key_of(item), container)
    if not isinstance(item, Scalar):
        return None
    if isinstance(container, Scalar) and isinstance(container.value, str):
        return str(item.value) in container.value
    if isinstance(container, ListValue):
        return _is_item(item, container)
    return None


def _is_key(key: object, container: MapValue) -> bool | None:
    if key is not OPEN and key in container.entries:
        return True
    return None if container.open or key is OPEN else False


def _is_item(item: Scalar, container: ListValue) -> bool | None:
    answers = [_compare("==", item, option) for option in container.items]
    if any(isinstance(answer, Scalar) and answer.value for answer in answers):
        return True
    unsure = container.open or any(isinstance(answer, Unknown) for answer in answers)
    return None if unsure else False


def _repeat(items: ListValue, times: Value) -> Value:
    if isinstance(times, Scalar) and isinstance(times.value, int):
        count = max(0, min(times.value, MAX_LENGTH // max(1, len(items.items))))
        is_whole = count == max(0, times.value) and not items.open
        return list_of(items.items * count, items.kind, certain=is_whole)
    return list_of(items.items, items.kind, certain=False)


def _hole_name(left: Value, right: Value) -> str:
    holes = [
        part.label for side in (left, right) for part in parts_of(side) if isinstance(part, Unknown)
    ]
    return holes[0] if holes else "?"


def percent_format(template: Value, given: Value) -> Value:
    """Return `template % given`, each known in part or whole (Python: printf-style formatting)."""
    values: list[Value] = list(given.items) if isinstance(given, ListValue) else [given]
    mapping = given.entries if isinstance(given, MapValue) else {}
    parts: list[Value] = []
    for part in parts_of(template):
        parts.extend(
            _format_conversions(part, values, mapping) if isinstance(part, str) else [part]
        )
    return concat(parts)


def _format_conversions(
    text: str, values: list[Value], mapping: Mapping[Any, Value]
) -> list[Value]:
    parts: list[Value] = []
    rest = text
    while "%" in rest:
        before, _, after = rest.partition("%")
        parts.append(Scalar(before))
        part, rest = _format_conversion(after, values, mapping)
        parts.append(part)
    return [*parts, Scalar(rest)]


def _format_conversion(
    after: str, values: list[Value], mapping: Mapping[Any, Value]
) -> tuple[Value, str]:
    """Return what one conversion puts in, and the text behind it; `after` begins behind the %."""
    name, rest = None, after
    if after.startswith("("):
        name, _, rest = after[1:].partition(")")
    flags = len(rest) - len(rest.lstrip("#0- +.123456789lh"))
    spec, kind, rest = rest[:flags], rest[flags : flags + 1], rest[flags + 1 :]
    if kind == "%":
        return Scalar("%"), rest
    value = mapping.get(name, Unknown(name)) if name else (values.pop(0) if values else UNKNOWN)
    return _format_value(spec + kind, value), rest


def _format_value(spec: str, value: Value) -> Value:
    if isinstance(value, Scalar) and spec != "s" and len(spec) < 8:  # noqa: PLR2004
        try:
            shown = ("%" + spec.replace("l", "")) % value.value
            return Scalar(_check_size(shown), value.tainted)
        except (TypeError, ValueError):
            return value
    return value


def unary(name: str, operand: Value) -> Value:
    """Return `-x`, `+x` or `~x`."""
    if isinstance(operand, Choice):
        return join([unary(name, option) for option in operand.options])
    if isinstance(operand, Scalar) and isinstance(operand.value, (int, float)):
        value = operand.value
        if name == "-":
            return Scalar(-value, operand.tainted)
        if name == "~" and isinstance(value, int):
            return Scalar(~int(value), operand.tainted)
        if name == "+":
            return operand
    return Unknown("?", is_tainted(operand))
