"""The functions that expressions have besides CEL's own: places, areas and distances.

They are written out in CEL before an expression is compiled. Functions in Python would be slower,
and cel-expr-python 0.1.3 loses the memory of the arguments of each call.
"""

import re
from collections.abc import Collection, Sequence
from string import Template
from typing import Any

from rtron.messages.expressions.protobuf_types import AREA, POINT, protobuf_name

FUNCTIONS = ("inside", "distance", "place")
RESERVED = frozenset(
    {"as", "break", "const", "continue", "else", "false", "for", "function", "if", "import", "in"}
    | {"let", "loop", "namespace", "null", "package", "return", "true", "var", "void", "while"}
)
"""The words of CEL that name no variable."""
NOT_FINITE = "a position is not finite"
"""What the evaluation of a position that is NaN or Inf ends with."""

_QUOTED = r'"{3}(?:E|.)*?"{3}|\'{3}(?:E|.)*?\'{3}|"(?:E|[^"])*?"|\'(?:E|[^\'])*?\''
TOKEN = re.compile(
    f"(?:[bB]?[rR]|[rR][bB])(?:{_QUOTED.replace('E|', '')})"
    f"|[bB]?(?:{_QUOTED.replace('E', chr(92) * 2 + '.')})" + r"|//[^\n]*|\s+|`[^`]*`|\w+|.",
    re.DOTALL | re.ASCII,
)
_FINITE = "math.isFinite(p.x) && math.isFinite(p.y)"
_NOT_FINITE_ERROR = f"{{'': $otherwise}}['{NOT_FINITE}']"
_CROSSES_ODD_EDGES = (
    "($area.edges.filter(e, (e.y > p.y) != (e.end > p.y) &&"
    " p.x < e.x + (p.y - e.y) * e.slope).size() % 2 == 1)"
)
_IN_BOX = "p.x >= $area.low_x && p.x <= $area.high_x && p.y >= $area.low_y && p.y <= $area.high_y"
_EDGE_PROJECTION = "((p.x - e.x) * e.dx + (p.y - e.y) * e.dy) * e.inverse"
_SQUARED_NORM = "(u.x) * (u.x) + (u.y) * (u.y)"
_SQUARED_EDGE_DISTANCE = _SQUARED_NORM.replace("u.x", "p.x - e.x - t * e.dx").replace(
    "u.y", "p.y - e.y - t * e.dy"
)
_EDGE_DISTANCE = (
    f"math.least($area.edges.map(e, [math.least(1.0, math.greatest(0.0, {_EDGE_PROJECTION}))]"
    f".map(t, math.sqrt({_SQUARED_EDGE_DISTANCE}))[0]))"
)
_SQUARED_POINT_DISTANCE = _SQUARED_NORM.replace("u.x", "p.x - q.x").replace("u.y", "p.y - q.y")
_EDGE_TOLERANCE_M = "1e-9"  # metres from an edge that count as inside: areas are mostly forbidden


def _template(text: str, otherwise: str) -> Template:
    """Give the names of the text's own variables a prefix that no user would take."""
    named = re.sub(r"(?<![\w.$'])([petqd])(?!\w)", r"rtron_\1", text)
    return Template(named.replace("$otherwise", otherwise))


_INSIDE = _template(
    f"[$point].exists(p, {_FINITE} ? {_IN_BOX} && ({_CROSSES_ODD_EDGES} ||"
    f" {_EDGE_DISTANCE} <= {_EDGE_TOLERANCE_M}) : {_NOT_FINITE_ERROR})",
    "true",
)
_DISTANCE_TO_AREA = _template(
    f"[$point].map(p, {_FINITE} ? ({_CROSSES_ODD_EDGES} ? 0.0 :"
    f" [{_EDGE_DISTANCE}].map(d, d <= {_EDGE_TOLERANCE_M} ? 0.0 : d)[0])"
    f" : {_NOT_FINITE_ERROR})[0]",
    "0.0",
)
_DISTANCE_TO_POINT = _template(
    f"[$point].map(p, [$other].map(q, {_FINITE} && {_FINITE.replace('p.', 'q.')} ?"
    f" math.sqrt({_SQUARED_POINT_DISTANCE}) : {_NOT_FINITE_ERROR})[0])[0]",
    "0.0",
)
_POINT_TEMPLATE = Template(f"{protobuf_name(POINT)}{{x: $x, y: $y}}")


def declarations(cel: Any, points: Sequence[str]) -> list[Any]:  # noqa: ANN401 - CEL has no types
    """Declare the functions for positions of the types `points`, for the checker only."""
    real, truth, area = cel.Type.DOUBLE, cel.Type.BOOL, cel.Type(protobuf_name(AREA))
    types = [cel.Type(protobuf_name(each)) for each in points]
    to_area = [[each, area] for each in types]
    between = [[one, other] for one in types for other in types]
    return [
        _declaration(cel, "inside", truth, to_area),
        _declaration(cel, "distance", real, to_area + between),
        _declaration(cel, "place", cel.Type(protobuf_name(POINT)), [[real, real]]),
    ]


def _declaration(cel: Any, name: str, result: Any, signatures: Sequence[Sequence[Any]]) -> Any:  # noqa: ANN401
    overloads = [
        cel.Overload(
            "_".join((name, *(each.name() for each in parameters))),
            return_type=result,
            parameters=parameters,
        )
        for parameters in signatures
    ]
    return cel.FunctionDecl(name, overloads)


def expand_functions(text: str, areas: Collection[str]) -> str:
    """Return an expression, which was checked, with CEL's own functions instead of ours.

    The area of a `distance` must be called by its name, one of `areas`.
    """
    return ",".join(_Expander(TOKEN.findall(text), areas).parts())


class _Expander:
    """Goes over the tokens of a text once."""

    def __init__(self, tokens: Sequence[str], areas: Collection[str]) -> None:
        self._tokens = tokens
        self._areas = areas
        self._at = 0

    def parts(self) -> list[str]:
        """Return what stands between the commas up to the bracket that closes, written out."""
        found = [""]
        before = "("
        while (word := self._next()) and word not in CLOSING:
            if word == ",":
                found.append("")
            elif word in FUNCTIONS and before != "." and self._enter_bracket():
                found[-1] += self._call(word)
            else:
                found[-1] += self._bracket(word) if word in BRACKETS else word
            before = before if _SPACE.match(word) else word
        return found

    def _next(self) -> str:
        token = self._tokens[self._at] if self._at < len(self._tokens) else ""
        self._at += 1
        return token

    def _bracket(self, token: str) -> str:
        return token + ",".join(self.parts()) + BRACKETS[token]

    def _enter_bracket(self) -> bool:
        """Go behind a bracket that opens, if it is the next token but spaces and comments."""
        at = self._at
        while at < len(self._tokens) and _SPACE.match(self._tokens[at]):
            at += 1
        opens = at < len(self._tokens) and self._tokens[at] == "("
        if opens:
            self._at = at + 1
        return opens

    def _call(self, name: str) -> str:
        one, other = (f"{part}\n" for part in self.parts())  # a comment ends with its line
        if name == "place":
            return _POINT_TEMPLATE.substitute(x=one, y=other)
        if name == "inside":
            return _INSIDE.substitute(point=one, area=f"({other})")
        if other.strip() in self._areas:
            return _DISTANCE_TO_AREA.substitute(point=one, area=f"({other})")
        return _DISTANCE_TO_POINT.substitute(point=one, other=other)


BRACKETS = {"(": ")", "[": "]", "{": "}"}
CLOSING = frozenset(BRACKETS.values())
_SPACE = re.compile(r"\s|//")
