"""The operators, functions and methods that `$(eval …)` may use here, and how large values get."""

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

from rtron.sources.launch.common.errors import UnresolvableError

_FIELD = re.compile(r"\{\w*(:[<>=^+ 0]*\d{0,3}(\.\d{1,2})?[a-z%]?)?\}")
_DIRECTIVE = re.compile(r"%[-+ 0#]*\d{0,3}(\.\d{1,2})?[a-z%]")


def format_braces(template: str, *values: Any) -> str:  # noqa: ANN401 - whatever an expression makes
    """Return `template.format(*values)`; raise UnresolvableError for more than plain fields."""
    if set("{}") & set(_FIELD.sub("", template)):
        raise UnresolvableError(f"format {template!r} is not of the kind that is evaluated here")
    return template.format(*values)


def format_percent(template: str, values: Any) -> str:  # noqa: ANN401 - as above
    """Return `template % values`; raise UnresolvableError for more than plain directives."""
    if "%" in _DIRECTIVE.sub("", template):
        raise UnresolvableError(f"format {template!r} is not of the kind that is evaluated here")
    result: str = template % values
    return result


Value: TypeAlias = Any
Function: TypeAlias = Callable[..., Value]

ANONYMOUS_SUFFIX = "_rtron_anonymous"
"""Stands for what launch makes up in `$(anon id)`: legal in a name, and a `*` in the end."""

MAX_LENGTH = 4096
MAX_BITS = 1024
_MAX_DIGITS = 100


def check_size(value: Value) -> Value:
    """Return a value as it is; raise UnresolvableError if it is too large to go on with."""
    size = value.bit_length() if isinstance(value, int) else 0
    length = len(value) if isinstance(value, (str, list, tuple)) else 0
    if size > MAX_BITS or length > MAX_LENGTH:
        raise UnresolvableError("an expression's value is too large")
    return value


def _multiply(left: Value, right: Value) -> Value:
    for text, times in ((left, right), (right, left)):
        if isinstance(text, (list, tuple)):
            raise UnresolvableError("a repeated list")
        if isinstance(text, str) and isinstance(times, int):
            check_size("x" * min(len(text) * max(times, 0), MAX_LENGTH + 1))
    return left * right


def _power(base: Value, exponent: Value) -> Value:
    if isinstance(base, int) and isinstance(exponent, int):
        check_size(1 << min(base.bit_length() * max(exponent, 0), MAX_BITS))
    return base**exponent


def _modulo(left: Value, right: Value) -> Value:
    return format_percent(left, right) if isinstance(left, str) else left % right


def _round(number: Value, digits: int | None = None) -> Value:
    if digits is not None and abs(digits) > _MAX_DIGITS:
        raise UnresolvableError("round() to so many digits")
    return round(number, digits)


def _attributes(owner: Any, names: str) -> dict[str, Value]:  # noqa: ANN401 - a module or a class
    return {name: getattr(owner, name) for name in names.split()}


BINARY: Mapping[type[ast.operator], Function] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _multiply,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _modulo,
    ast.Pow: _power,
}
UNARY: Mapping[type[ast.unaryop], Function] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
COMPARE: Mapping[type[ast.cmpop], Function] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda item, items: item in items,
    ast.NotIn: lambda item, items: item not in items,
}
CONSTANTS: Mapping[str, Value] = {
    "true": True,
    "false": False,
    **_attributes(math, "e inf nan pi tau"),
}
FUNCTIONS: Mapping[str, Function] = {
    **{f.__name__: f for f in (abs, bool, float, int, len, list, max, min, sorted, str, sum)},
    **_attributes(math, "acos asin atan atan2 ceil copysign cos degrees exp fabs floor fmod hypot"),
    **_attributes(math, "isinf isnan log log10 pow radians sin sqrt tan trunc"),
    "round": _round,
}
METHODS: Mapping[str, Function] = {
    **_attributes(str, "capitalize count endswith find index isdigit join lower lstrip replace"),
    **_attributes(str, "rstrip split startswith strip title upper"),
    "format": format_braces,
}


def anonymous_to_wildcard(text: str) -> str:
    """Return a text with a `*` where launch makes up a part of a name."""
    return text.replace(ANONYMOUS_SUFFIX, "_*")
