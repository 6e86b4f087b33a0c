"""Macros: their definitions, and their expansion in a piece of code (C++17, clause 19.3).

An expansion keeps the lines of the code: newlines between a macro's arguments follow its text.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

ENCODING = r"(?:u8|[uUL])?"
STRING = ENCODING + r'"(?:\\(?s:.)|[^"\\\n])*"?'
RAW_STRING = ENCODING + r'R"(?P<raw>[^()\\\s]{0,16})\((?s:.*?)(?:\)(?P=raw)"|\Z)'
CHARACTER = ENCODING + r"'(?:\\.|[^'\\\n]){1,12}'"
_TOKEN = re.compile(rf"{RAW_STRING}|{STRING}|{CHARACTER}|\.?\d(?:[\w.']|[eEpP][+-])*|[A-Za-z_]\w*")
_ARGUMENT = re.compile(rf"{RAW_STRING}|{STRING}|{CHARACTER}|[(),\[\]{{}}]")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_OPEN = re.compile(r"\s*\(")
_BODY = re.compile(
    rf"{RAW_STRING}|{STRING}|{CHARACTER}|(?P<paste>(?<!\s)\s*##\s*)|#\s*(?P<str>\w+)|\w+"
)
_PASTE = re.compile(r"\s*##")
_MAX_EXPANDED = 2_000_000
_MAX_USE = 500_000
"""Characters that one macro in the code may become, those of its steps counted."""
_MAX_ARGUMENTS = 5_000
_NON_CALL_COST = 1_000
_MAX_DEPTH = 40


@dataclass(frozen=True, slots=True)
class Macro:
    """A macro; `params` is None where it is object-like, a last one of "..." takes the rest."""

    body: str
    params: tuple[str, ...] | None = None
    line: int = 0


class _TooLongError(Exception):
    """A use of a macro becomes longer than is read."""


class MacroTable:
    """The macros known at a location of a file, and what they make of its code.

    `oversized` are the uses that are left as they stand since they become too long: the macro's
    name, and the line in the code that was to be expanded, from 0.
    """

    def __init__(self) -> None:
        self.defined: dict[str, Macro] = {}
        self.oversized: list[tuple[str, int]] = []
        self._expansion_left = _MAX_EXPANDED
        self._left_after_use = 0
        self._depth = 0

    @property
    def is_exhausted(self) -> bool:
        """Whether so much was expanded that the rest was left as it stands."""
        return self._expansion_left <= 0

    def expand(self, code: str) -> str:
        """Return the code (without directives and comments) with its macros expanded."""
        if self.defined.keys().isdisjoint(_IDENTIFIER.findall(code)):
            return code
        return self._expand(code, frozenset())

    def _expand(self, code: str, hidden: frozenset[str]) -> str:
        expand_use = self._expand_use if self._depth else self._expand_outermost_use
        out: list[str] = []
        position = copied = 0
        while found := _TOKEN.search(code, position):
            position = found.end()
            name = found.group()
            if name in self.defined and name not in hidden and self._may_expand:
                used = expand_use(name, code, position, hidden)
                if used is not None:
                    out += (code[copied : found.start()], used[0])
                    copied = position = used[1]
        out.append(code[copied:])
        return "".join(out)

    def _expand_outermost_use(
        self, name: str, code: str, end: int, hidden: frozenset[str]
    ) -> tuple[str, int] | None:
        """Expand a use as `_expand_use` does; one that becomes too long stays, with its call."""
        self._left_after_use = self._expansion_left - _MAX_USE
        try:
            return self._expand_use(name, code, end, hidden)
        except _TooLongError:
            self._depth = 0
            self._expansion_left = self._left_after_use
            self.oversized.append((name, code.count("\n", 0, end)))
            call = call_arguments(code, end)
            after = call[1] if call else end
            return code[end - len(name) : after], after

    def _expand_use(
        self, name: str, code: str, end: int, hidden: frozenset[str]
    ) -> tuple[str, int] | None:
        """Return what the macro becomes and where the code goes on, None if it is no use of it."""
        macro = self.defined[name]
        hidden |= {name}
        if macro.params is None and self._is_alias(macro.body, hidden):
            return self._expand_use(macro.body, code, end, hidden) or (macro.body, end)
        body, lines = macro.body, 0
        if macro.params is not None:
            call = call_arguments(code, end)
            if call is None:
                self._spend(_NON_CALL_COST)
                return None
            args, after = call
            expanded = [self._expand_nested(arg, hidden - {name}) for arg in args]
            body, lines, end = (
                _substitute_parameters(macro, args, expanded),
                code.count("\n", end, after),
                after,
            )
        return self._expand_nested(body, hidden).replace("\n", " ") + "\n" * lines, end

    @property
    def _may_expand(self) -> bool:
        """Whether a use may begin; what one has begun is bounded by itself."""
        return self._depth > 0 or not self.is_exhausted

    def _spend(self, cost: int) -> None:
        self._expansion_left -= cost
        if self._expansion_left < self._left_after_use:
            raise _TooLongError

    def _is_alias(self, body: str, hidden: frozenset[str]) -> bool:
        return body in self.defined and body not in hidden and len(hidden) < _MAX_DEPTH

    def _expand_nested(self, body: str, hidden: frozenset[str]) -> str:
        self._spend(len(body) + 1)
        if self._depth >= _MAX_DEPTH:
            return body
        self._depth += 1
        expanded = self._expand(body, hidden)
        self._depth -= 1
        return expanded


def call_arguments(code: str, end: int) -> tuple[list[str], int] | None:
    """Return the arguments of a call that may open behind `end`, and where it closes."""
    opened = _OPEN.match(code, end)
    if not opened:
        return None
    args: list[str] = []
    depth, start = 0, opened.end()
    for found in _ARGUMENT.finditer(code, start, start + _MAX_ARGUMENTS):
        symbol = found.group()
        if symbol == ")" and depth == 0:
            return [*args, code[start : found.start()].strip()], found.end()
        if symbol == "," and depth == 0:
            args.append(code[start : found.start()].strip())
            start = found.end()
        depth += {"(": 1, ")": -1}.get(symbol, 0)
    return None


def _substitute_parameters(macro: Macro, args: Sequence[str], expanded: Sequence[str]) -> str:
    """Return the macro's body with its parameters replaced; raise _TooLongError for a long one."""
    raw, full = _argument_map(macro, args), _argument_map(macro, expanded)
    body, length, pasted_at = macro.body, 0, -1

    def replaced(found: re.Match[str]) -> str:
        nonlocal length, pasted_at
        if found["paste"]:
            pasted_at = found.end()
            return ""
        if found["str"]:
            text = _stringify(raw[found["str"]]) if found["str"] in raw else found.group()
        else:
            pasted = found.start() == pasted_at or _PASTE.match(body, found.end())
            text = (raw if pasted else full).get(found.group(), found.group())
        length += len(text)
        if length > _MAX_USE:
            raise _TooLongError
        return text

    return _BODY.sub(replaced, body)


def _argument_map(macro: Macro, args: Sequence[str]) -> dict[str, str]:
    params = macro.params or ()
    named = dict(zip((name for name in params if name != "..."), args, strict=False))
    if params[-1:] == ("...",):
        named["__VA_ARGS__"] = ", ".join(args[len(params) - 1 :])
    return named


def _stringify(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ")
    return f'"{escaped}"'
