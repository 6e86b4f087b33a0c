"""Expressions over the fields of messages, in CEL (cel.dev), checked against the definition.

Google's C++ runtime evaluates them: expressions have no loops but the macros over lists, whose
rounds it bounds; regular expressions are RE2's, which take linear time. Besides CEL's own there
are `inside(point, area)`, `distance(point, point or area)` in metres on the ground, 0 inside, and
`place(x, y)`, a point in the frame that the rule names.
"""

import importlib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from rtron.errors import InputError
from rtron.messages.common.definition import Definition
from rtron.messages.expressions.errors import expression_error
from rtron.messages.expressions.frames import is_point, without_slash
from rtron.messages.expressions.functions import (
    FUNCTIONS,
    NOT_FINITE,
    declarations,
    expand_functions,
)
from rtron.messages.expressions.number_checks import NOT_A_NUMBER, check_numbers
from rtron.messages.expressions.protobuf_types import (
    AREA,
    area_value,
    descriptor_pool,
    protobuf_name,
    types_of,
)
from rtron.vocabulary import Area

MAX_EXPRESSION = 1 << 12
"""The longest expression accepted, in characters."""
_MAX_MESSAGE = 300
_MAX_SHOWN = 60
_RESERVED = re.compile(
    "as|break|const|continue|else|false|for|function|if|import|in|let|loop|namespace|null|package"
    "|return|true|var|void|while"
)
_WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_POINT_CALL = re.compile(r"(?<!\w)place(?:\s|//[^\n]*\n)*\(", re.ASCII)
_MIN_POINTS = 3


class ExpressionCompiler:
    """The expressions over messages of one type, which they call `subject`."""

    def __init__(self, definition: Definition, subject: str, areas: Sequence[Area] = ()) -> None:
        cel = _cel("cel")
        self._definition = definition
        self._subject = subject
        self._areas = {_checked_area(area, subject).name: area for area in areas}
        self._pool = descriptor_pool(definition)
        self.message = self._class(definition.type)
        """The protobuf class of the messages."""
        self._env = cel.NewEnv(
            descriptor_pool=self._pool,
            variables={
                subject: cel.Type(protobuf_name(definition.type)),
                **{name: cel.Type(protobuf_name(AREA)) for name in self._areas},
            },
            functions=declarations(cel, self._points()),
            extensions=[_cel("ext.ext_math").ExtMath()],
        )
        make = self._class(AREA)
        self._area_values = {name: area_value(make, area) for name, area in self._areas.items()}

    def compile(self, text: str) -> Any:  # noqa: ANN401 - CEL's expression has no types
        """Return the expression; InputError, with the place in the text, if it is not boolean."""
        _check_text(text)
        try:
            compiled = self._env.compile(text)
        except RuntimeError as error:
            raise expression_error(
                str(error), text, types_of(self._definition), self._names()
            ) from error
        if compiled.return_type().name() != "BOOL":
            raise InputError(
                f"the expression {_short(text)} gives {compiled.return_type().name()}, not a truth",
                help="compare it with something: == != < <= > >=",
            )
        expanded = expand_functions(check_numbers(text), self._areas)
        return compiled if expanded == text else self._compile_expanded(expanded)

    def _compile_expanded(self, expanded: str) -> Any:  # noqa: ANN401 - CEL's expression has no types
        try:
            return self._env.compile(expanded)
        except RuntimeError as error:
            raise InputError(
                f"the expression compares in too deep a way: {str(error)[:_MAX_MESSAGE]}",
                help="name areas directly in inside() and distance(), and nest fewer brackets",
            ) from error

    def activate(self, message: Any, areas: Mapping[str, Any]) -> Any:  # noqa: ANN401 - CEL's
        """Return what expressions about this message and these areas are evaluated with."""
        return self._env.Activation({self._subject: message, **areas})

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


def evaluate(expression: Any, activation: Any) -> bool | str:  # noqa: ANN401 - CEL has no types
    """Return whether an expression holds, or why that is not known."""
    try:
        value = expression.eval(activation).value()
    except Exception as error:  # noqa: BLE001 - a stranger's message must not end the guard
        value = str(error)
    if value is True or value is False:
        return value
    for known in (NOT_FINITE, NOT_A_NUMBER):
        if known in str(value):
            return known
    return re.sub(r"^[A-Z_]+: | \[[A-Z_]+\]$", "", str(value)[:_MAX_MESSAGE]) or "no value"


def _cel(module: str) -> Any:  # noqa: ANN401 - CEL has no types
    try:
        return importlib.import_module(f"cel_expr_python.{module}")
    except ImportError as error:
        raise InputError(
            "expressions over message fields need the package cel-expr-python",
            help="pip install cel-expr-python; there are wheels for x86_64 and Python 3.11 or newer"
            " only. Presence, silence and combinations of eflows work without it.",
        ) from error


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
    is_reserved = name in (*FUNCTIONS, "math", subject) or _RESERVED.fullmatch(name)
    if is_reserved or not _WORD.fullmatch(name):
        raise InputError(f"an area cannot be called {name!r}", help="take letters, digits and _")
    if len(area.polygon) < _MIN_POINTS:
        raise InputError(f"the area {name} has fewer than {_MIN_POINTS} corners")
    return area
