"""What CEL's operators and functions do, in Python: 64-bit integers, IEEE 754, errors as values.

Comparisons with NaN and positions that are not finite are errors, as in `number_checks` and
`functions`.
"""

import math
import operator
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from rtron.messages.expressions.functions import NOT_FINITE
from rtron.messages.expressions.geometry import (
    TOLERANCE,
    BoundingBox,
    PolygonEdge,
    bounding_box,
    polygon_edges,
)
from rtron.messages.expressions.number_checks import NOT_A_NUMBER
from rtron.messages.expressions.static_types import BOOL, BYTES, DOUBLE, INT, STRING, StaticType
from rtron.vocabulary import Area

_LIMIT = 1 << 63

Function = Callable[..., Any]
Signature = tuple[StaticType, ...]


class EvaluationError(Exception):
    """The value of an expression is not known."""


def int64(value: int) -> int:
    """Return an integer of CEL's; EvaluationError if it has more than 64 bits."""
    if not -_LIMIT <= value < _LIMIT:
        raise EvaluationError("integer overflow")
    return value


def check_nan(*values: Any) -> None:  # noqa: ANN401 - of any type
    """Raise EvaluationError if a value, or one in a list, is NaN."""
    for value in values:
        if isinstance(value, float) and math.isnan(value):
            raise EvaluationError(NOT_A_NUMBER)
        if isinstance(value, list):
            check_nan(*value)


def comparison(compare: Function) -> Function:
    """Return a comparison that is an error for NaN."""

    def checked(left: Any, right: Any) -> bool:  # noqa: ANN401
        check_nan(left, right)
        return bool(compare(left, right))

    return checked


def is_in(value: Any, values: list[Any]) -> bool:  # noqa: ANN401
    """Tell whether a value is in a list."""
    check_nan(value)
    return value in values


def _integer(compute: Callable[[int, int], int]) -> Function:
    return lambda left, right: int64(compute(left, right))


def _quotient(left: int, right: int) -> int:
    """Divide towards 0."""
    if right == 0:
        raise EvaluationError("divide by zero")
    found = abs(left) // abs(right)
    return found if (left < 0) == (right < 0) else -found


def _remainder(left: int, right: int) -> int:
    if right == 0:
        raise EvaluationError("modulus by zero")
    return left - right * _quotient(left, right)


def _real_quotient(left: float, right: float) -> float:
    if right:
        return left / right
    if left == 0 or math.isnan(left):
        return math.nan
    return math.copysign(math.inf, left) * math.copysign(1.0, right)


ARITHMETIC: dict[str, dict[StaticType, Function]] = {
    "+": {
        INT: _integer(operator.add),
        DOUBLE: operator.add,
        STRING: operator.add,
        BYTES: operator.add,
    },
    "-": {INT: _integer(operator.sub), DOUBLE: operator.sub},
    "*": {INT: _integer(operator.mul), DOUBLE: operator.mul},
    "/": {INT: _integer(_quotient), DOUBLE: _real_quotient},
    "%": {INT: _integer(_remainder)},
}
"""Operators by the type of both sides, which is that of the result, too."""

ORDER = {
    "<": comparison(operator.lt),
    "<=": comparison(operator.le),
    ">": comparison(operator.gt),
    ">=": comparison(operator.ge),
}
EQUALITY = {"==": comparison(operator.eq), "!=": comparison(operator.ne)}
NEGATION: dict[StaticType, Function] = {INT: lambda x: int64(-x), DOUBLE: operator.neg}


def matches(text: str, pattern: str) -> bool:
    """Tell whether an RE2 expression is found in a text, in linear time."""
    import re2  # noqa: PLC0415 - only where Google's CEL is missing

    try:
        return re2.search(pattern, text) is not None
    except re2.error as error:
        raise EvaluationError(f"invalid regular expression: {error}") from error


def _rounded_to_integer(value: float) -> int:
    if not math.isfinite(value) or abs(value) >= _LIMIT:
        raise EvaluationError("integer overflow")
    return int(value)


def _square_root(value: float) -> float:
    return math.sqrt(value) if value >= 0 else math.nan


_SIZES: dict[tuple[str, Signature], tuple[StaticType, Function]] = {
    ("size", (each,)): (INT, len) for each in (STRING, BYTES)
}
METHODS_OF_TYPES: dict[tuple[str, Signature], tuple[StaticType, Function]] = {
    **_SIZES,
    ("startsWith", (STRING, STRING)): (BOOL, str.startswith),
    ("endsWith", (STRING, STRING)): (BOOL, str.endswith),
    ("contains", (STRING, STRING)): (BOOL, operator.contains),
    ("matches", (STRING, STRING)): (BOOL, matches),
}
"""Methods by their name and the types of what they are called on and of their arguments: the type
of the result, and what it is.
"""

FUNCTIONS_OF_TYPES: dict[tuple[str, Signature], tuple[StaticType, Function]] = {
    **_SIZES,
    ("matches", (STRING, STRING)): (BOOL, matches),
    ("int", (INT,)): (INT, int),
    ("int", (DOUBLE,)): (INT, _rounded_to_integer),
    ("double", (INT,)): (DOUBLE, float),
    ("double", (DOUBLE,)): (DOUBLE, float),
    ("math.isNaN", (DOUBLE,)): (BOOL, math.isnan),
    ("math.isInf", (DOUBLE,)): (BOOL, math.isinf),
    ("math.isFinite", (DOUBLE,)): (BOOL, math.isfinite),
    ("math.abs", (INT,)): (INT, lambda x: int64(abs(x))),
    ("math.abs", (DOUBLE,)): (DOUBLE, abs),
    ("math.sqrt", (INT,)): (DOUBLE, _square_root),
    ("math.sqrt", (DOUBLE,)): (DOUBLE, _square_root),
}
"""Functions by their name and the types of their arguments: the type of the result, and what it is.

Methods are none of them: CEL knows `size` and `matches` as both.
"""

_NUMBERS = frozenset({INT, DOUBLE})
_PLAIN = _NUMBERS | {BOOL, STRING, BYTES}
_ELSEWHERE: dict[str, frozenset[StaticType]] = {
    "int": frozenset({STRING}),
    "double": frozenset({STRING}),
    "uint": _NUMBERS | {STRING},
    "string": _PLAIN,
    "bytes": frozenset({STRING, BYTES}),
    "bool": frozenset({BOOL, STRING}),
    "duration": frozenset({STRING}),
    "timestamp": frozenset({INT, STRING}),
    "math.sign": _NUMBERS,
    **dict.fromkeys(("math.greatest", "math.least"), _NUMBERS),
    **dict.fromkeys(
        [f"math.{each}" for each in ("ceil", "floor", "round", "trunc")], frozenset({DOUBLE})
    ),
    **dict.fromkeys([f"math.bit{each}" for each in ("And", "Or", "Xor", "Not")], frozenset({INT})),
    **dict.fromkeys(("math.bitShiftLeft", "math.bitShiftRight"), frozenset({INT})),
}


def is_elsewhere(name: str, types: Signature) -> bool:
    """Tell whether only Google's CEL has a function, with arguments of these types."""
    known = _ELSEWHERE.get(name, frozenset())
    return name in ("dyn", "type") or (bool(types) and known.issuperset(types))


def extreme(choose: Function) -> Function:
    """Return what takes the greatest or least of its arguments; none and NaN are errors."""

    def chosen(*values: Any) -> Any:  # noqa: ANN401
        if not values:
            raise EvaluationError("an empty list has no greatest or least element")
        check_nan(*values)
        return choose(values)

    return chosen


class AreaShape:
    """The edges of an area, and the box around it."""

    def __init__(self, area: Area) -> None:
        self.edges: tuple[PolygonEdge, ...] = tuple(polygon_edges(area.polygon))
        self.box: BoundingBox = bounding_box(area.polygon)

    def distance(self, x: float, y: float) -> float:
        """Return how far a place is from the area (m), 0 inside and on its edges."""
        crossed = sum(
            (edge.y > y) != (edge.end > y) and x < edge.x + (y - edge.y) * edge.slope
            for edge in self.edges
        )
        if crossed % 2:
            return 0.0
        nearest = min(_edge_distance(edge, x, y) for edge in self.edges)
        return nearest if nearest > TOLERANCE else 0.0


def _edge_distance(edge: PolygonEdge, x: float, y: float) -> float:
    along = ((x - edge.x) * edge.dx + (y - edge.y) * edge.dy) * edge.inverse
    along = min(1.0, max(0.0, along))
    return math.hypot(x - edge.x - along * edge.dx, y - edge.y - along * edge.dy)


def place(x: float, y: float) -> SimpleNamespace:
    """Return a point on the ground."""
    return SimpleNamespace(x=x, y=y, z=0.0)


def inside(point: Any, area: AreaShape) -> bool:  # noqa: ANN401 - a message or a place
    """Tell whether a point is in an area."""
    _check_finite(point)
    box = area.box
    near = box.low_x <= point.x <= box.high_x and box.low_y <= point.y <= box.high_y
    return near and area.distance(point.x, point.y) == 0.0


def distance_to_area(point: Any, area: AreaShape) -> float:  # noqa: ANN401
    """Return how far a point is from an area (m)."""
    _check_finite(point)
    return area.distance(point.x, point.y)


def distance_to_point(point: Any, other: Any) -> float:  # noqa: ANN401
    """Return how far two points are from each other on the ground (m)."""
    _check_finite(point)
    _check_finite(other)
    dx, dy = point.x - other.x, point.y - other.y
    return math.sqrt(dx * dx + dy * dy)


def _check_finite(point: Any) -> None:  # noqa: ANN401
    if not (math.isfinite(point.x) and math.isfinite(point.y)):
        raise EvaluationError(NOT_FINITE)
