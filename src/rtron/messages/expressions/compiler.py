"""Expressions over the fields of messages, in CEL (cel.dev), checked against the definition.

Google's C++ runtime evaluates them, where it has wheels; elsewhere `python_compiler` does.
Expressions have no loops but the macros over lists, whose rounds are bounded; regular expressions
are RE2's, which take linear time. Besides CEL's own there
are `inside(point, area)`, `distance(point, point or area)` in metres on the ground, 0 inside, and
`place(x, y)`, a point in the frame that the rule names.
"""

import importlib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rtron.errors import InputError
from rtron.messages.common.definition import Definition
from rtron.messages.expressions.errors import CheckError, expression_error
from rtron.messages.expressions.frames import is_point, without_slash
from rtron.messages.expressions.functions import FUNCTIONS, NOT_FINITE, RESERVED
from rtron.messages.expressions.number_checks import NOT_A_NUMBER
from rtron.messages.expressions.protobuf_types import (
    AREA,
    POINT,
    descriptor_pool,
    protobuf_name,
    types_of,
)
from rtron.messages.expressions.static_types import AREA_TYPE, message_type
from rtron.vocabulary import Area

if TYPE_CHECKING:
    from rtron.messages.expressions.google_compiler import GoogleCompiler
    from rtron.messages.expressions.python_compiler import PythonCompiler

MAX_EXPRESSION = 1 << 12
"""The longest expression accepted, in characters."""
_MAX_MESSAGE = 300
_MAX_SHOWN = 60
_WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_POINT_CALL = re.compile(r"(?<!\w)place(?:\s|//[^\n]*\n)*\(", re.ASCII)
_MIN_POINTS = 3


class ExpressionCompiler:
    """The expressions over messages of one type, which they call `subject`."""

    def __init__(self, definition: Definition, subject: str, areas: Sequence[Area] = ()) -> None:
        self._definition = definition
        self._subject = subject
        self._areas = {_checked_area(area, subject).name: area for area in areas}
        self._pool = descriptor_pool(definition)
        self.message = self._class(definition.type)
        """The protobuf class of the messages."""
        self._cel = self._compiler()
        make = self._class(AREA)
        self._area_values = {name: self._cel.area(make, area) for name, area in self._areas.items()}

    def _compiler(self) -> "GoogleCompiler | PythonCompiler":
        """Return Google's CEL if it is installed, else the one in Python."""
        cel = _google_cel()
        if cel:
            from rtron.messages.expressions.google_compiler import GoogleCompiler  # noqa: PLC0415

            subject = self._subject, self._definition.type
            return GoogleCompiler(cel, subject, self._areas, self._pool, self._points())
        return python_compiler(self._definition, self._subject, self._areas)

    def compile(self, text: str) -> Callable[[Any], Any]:
        """Return what evaluates an expression; InputError, with the place, if it is not boolean."""
        _check_text(text)
        try:
            type, compiled = self._cel.compile(text)
        except (RuntimeError, CheckError) as error:
            raise expression_error(
                str(error), text, types_of(self._definition), self._names()
            ) from error
        if type != "BOOL":
            raise InputError(
                f"the expression {_short(text)} gives {type}, not a truth",
                help="compare it with something: == != < <= > >=",
            )
        return compiled

    def activate(self, message: Any, areas: Mapping[str, Any]) -> Any:  # noqa: ANN401 - CEL's
        """Return what expressions about this message and these areas are evaluated with."""
        return self._cel.activate({self._subject: message, **areas})

    def areas(self, texts: Iterable[str]) -> dict[str, Any]:
        """Return the areas that `texts` name, as values."""
        return {name: self._area_values[name] for text in texts for name, _ in self._uses(text)}

    def frame(self, text: str, requested: str) -> str:
        """Return the frame that the positions in `text` are compared in, empty if in any.

        It is the one asked for and that of the areas; InputError if these differ.
        """
        frames = {name: without_slash(area.frame) for name, area in self._uses(text)}
        if requested:
            frames["the rule"] = without_slash(requested)
        if len(set(frames.values())) > 1:
            listed = ", ".join(f"{name} in {frame or 'no frame'}" for name, frame in frames.items())
            raise InputError(f"the positions in {_short(text)} are in different frames: {listed}")
        if not frames and _POINT_CALL.search(text):
            raise InputError(
                f"place() in {_short(text)} is in no frame", help="name one, for example frame: map"
            )
        return next(iter(frames.values()), "")

    def fields(self, text: str) -> set[str]:
        """Return the fields that evaluating `text` may look at, by their names; some too many."""
        every = {field.name for field in self._definition.fields}
        if re.search(rf"(?<!\w){self._subject}(?!\w)(?!\s*\.)", text, re.ASCII):
            return every
        return every & set(_WORD.findall(text))

    def _uses(self, text: str) -> Iterator[tuple[str, Area]]:
        words = set(_WORD.findall(text))
        return ((name, area) for name, area in self._areas.items() if name in words)

    def _names(self) -> list[str]:
        return [self._subject, *self._areas, *FUNCTIONS]

    def _class(self, type: str) -> Any:  # noqa: ANN401 - a class that protobuf makes
        from google.protobuf.message_factory import GetMessageClass  # noqa: PLC0415 - as below

        return GetMessageClass(self._pool.FindMessageTypeByName(protobuf_name(type)))

    def _points(self) -> list[str]:
        return [each.type for each in types_of(self._definition).values() if is_point(each)]


def evaluate(expression: Callable[[Any], Any], activation: Any) -> bool | str:  # noqa: ANN401 - CEL's
    """Return whether an expression holds, or why that is not known."""
    try:
        value = expression(activation)
    except Exception as error:  # noqa: BLE001 - a stranger's message must not end the guard
        value = str(error)
    if value is True or value is False:
        return value
    for known in (NOT_FINITE, NOT_A_NUMBER):
        if known in str(value):
            return known
    return re.sub(r"^[A-Z_]+: | \[[A-Z_]+\]$", "", str(value)[:_MAX_MESSAGE]) or "no value"


def _google_cel() -> Any:  # noqa: ANN401 - CEL has no types
    """Return Google's CEL, None where it has no wheel."""
    try:
        importlib.import_module("cel_expr_python.ext.ext_math")
        importlib.import_module("cel_expr_python.cel")
        return importlib.import_module("cel_expr_python")
    except ImportError:
        return None


def python_compiler(
    definition: Definition, subject: str, areas: Mapping[str, Area]
) -> "PythonCompiler":
    """Return the compiler in Python; InputError if its parser is not installed."""
    try:
        importlib.import_module("celpy")
    except ImportError as error:
        raise InputError(
            "expressions over message fields need the package cel-expr-python or cel-python",
            help="pip install cel-python. Presence, silence and combinations of eflows work"
            " without it.",
        ) from error
    from rtron.messages.expressions.python_compiler import PythonCompiler  # noqa: PLC0415

    point = message_type(types_of(definition)[POINT])
    variables = {subject: message_type(definition), **dict.fromkeys(areas, AREA_TYPE)}
    return PythonCompiler(variables, point)


def _short(text: str) -> str:
    return repr(text if len(text) <= _MAX_SHOWN else text[:_MAX_SHOWN] + "…")


def _check_text(text: str) -> None:
    if len(text) > MAX_EXPRESSION:
        raise InputError(f"an expression is longer than {MAX_EXPRESSION} characters")
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise InputError(f"column {error.start + 1}: not a character: {error.reason}") from error


def _checked_area(area: Area, subject: str) -> Area:
    name = area.name
    is_reserved = name in (*FUNCTIONS, "math", subject) or name in RESERVED
    if is_reserved or not _WORD.fullmatch(name):
        raise InputError(f"an area cannot be called {name!r}", help="take letters, digits and _")
    if len(area.polygon) < _MIN_POINTS:
        raise InputError(f"the area {name} has fewer than {_MIN_POINTS} corners")
    return area
