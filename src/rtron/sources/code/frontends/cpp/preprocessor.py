"""The preprocessor: comments and dead branches go, macros are expanded, lines keep their numbers.

Files that are included are not read; their names are kept (C++17, clause 19).
"""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import ClassVar

from rtron.sources.code.endpoint_calls import ENDPOINT_CALL
from rtron.sources.code.frontends.cpp.macros import (
    CHARACTER,
    ENCODING,
    RAW_STRING,
    STRING,
    Macro,
    MacroTable,
)
from rtron.sources.code.frontends.cpp.predefined_macros import (
    LOGGING_MACROS,
    PREDEFINED_MACROS,
    QT_MACROS,
)
from rtron.sources.code.frontends.cpp.preprocessor_condition import is_true
from rtron.sources.code.ir import SourceProblem

_CONTINUED = r"(?:\\\n|[^\n])*"
_PIECE = re.compile(
    rf"/\*(?s:.*?)(?:\*/|\Z)|//{_CONTINUED}|\n[ \t]*#{_CONTINUED}"
    rf"|{RAW_STRING.removeprefix(ENCODING)}|{STRING.removeprefix(ENCODING)}"
    rf"|{CHARACTER.removeprefix(ENCODING)}"
)
"""Comments, directives with the newline before them, and what neither is looked for in.

Each begins with a letter of its own, which lets the search skip what lies between.
"""
_COMMENT = re.compile(rf"(?P<comment>/\*(?s:.*?)(?:\*/|\Z)|//.*)|{STRING}|{CHARACTER}")
_DIRECTIVE = re.compile(r"\s*#\s*(\w*)\s*(.*)", re.DOTALL)
_DEFINE = re.compile(r"(\w+)(?:\(([^()]*)\))?\s*(.*)", re.DOTALL)
_SPLICED = re.compile(r"^(?:.*\\\n)+.*", re.MULTILINE)
_QT = re.compile(r"\bQ_OBJECT\b|<Q[A-Z]\w+>|\bemit \w")
_MACRO_NAME = re.compile(r"\b(?!defined\b)[A-Za-z_]\w*")
_OTHER_PLATFORMS = frozenset(
    {"WIN32", "_WIN32", "_WIN64", "_MSC_VER", "__APPLE__", "__ANDROID__", "ANDROID", "__QNX__"}
)
_MAY_BE_QT = ("Q_OBJECT", "<Q", "emit ")


@dataclass(frozen=True, slots=True)
class PreprocessedFile:
    """The code that is left, on its lines, and what the directives said."""

    code: str
    includes: tuple[str, ...]
    macros: Mapping[str, Macro]
    problems: tuple[SourceProblem, ...]


def preprocess(text: str, defined: Mapping[str, str]) -> PreprocessedFile:
    """Return what the compiler sees of a file; `defined` are object-like macros known before it.

    What cannot be read, an `#if` or an `#endif` without its `#if`, is among the problems.
    """
    reader = _DirectiveReader(MacroTable())
    reader.macros.defined.update(_predefined(qt=_is_qt(text)))
    known = {name: Macro(body) for name, body in defined.items()}
    reader.macros.defined.update(known)
    before = dict(reader.macros.defined)
    code = reader.read(text)
    macros = {k: v for k, v in reader.macros.defined.items() if before.get(k) is not v}
    return PreprocessedFile(code, tuple(reader.includes), macros, tuple(reader.problems))


def _is_qt(text: str) -> bool:
    return any(word in text for word in _MAY_BE_QT) and _QT.search(text) is not None


@cache
def _predefined(*, qt: bool) -> Mapping[str, Macro]:
    """Return the macros that are defined before a file begins, read once."""
    reader = _DirectiveReader(MacroTable())
    reader.read(PREDEFINED_MACROS + LOGGING_MACROS + (QT_MACROS if qt else ""))
    return reader.macros.defined


@dataclass(slots=True)
class _Branch:
    """An open `#if`: whether its present branch lives, and whether one already did.

    `condition` is what the present branch asks. `lost_call` is the first call of a branch that does
    not live that would make an endpoint, with its line; `has_calls` says that a living one does.
    """

    is_active: bool
    was_taken: bool
    line: int
    condition: str = ""
    lost_call: tuple[str, int, str] | None = None
    has_calls: bool = False


@dataclass(slots=True)
class _DirectiveReader:
    """Reads a file's directives in order."""

    macros: MacroTable
    includes: list[str] = field(default_factory=list)
    problems: list[SourceProblem] = field(default_factory=list)
    _branches: list[_Branch] = field(default_factory=list)
    _line: int = 1

    def read(self, text: str) -> str:
        self._line = 1
        code = "".join(self._pieces(text))
        for branch in self._branches:
            self._problem("#if without #endif", branch.line)
        self._branches.clear()
        if self.macros.is_exhausted:
            self._problem("macros expand to too much text; the rest is not expanded")
        return code

    def _pieces(self, text: str) -> Iterator[str]:
        """Yield the live code between directives, and the newlines of all that goes."""
        segment: list[str] = []
        text, position = f"\n{text}", 1
        for found in _PIECE.finditer(text):
            piece = found.group()
            if piece[0] not in "/\n":
                continue
            start = found.start() + (piece[0] == "\n")
            segment.append(text[position:start])
            position = found.end()
            lines = text.count("\n", start, position)
            if piece[0] == "/":
                segment.append(" " + "\n" * lines)
                continue
            yield self._expand_segment(segment)
            self._directive(piece[1:])
            self._line += lines
            yield "\n" * lines
        segment.append(text[position:])
        yield self._expand_segment(segment)

    def _expand_segment(self, segment: list[str]) -> str:
        code = "".join(segment)
        segment.clear()
        lines = code.count("\n")
        if self._branches:
            self._note_calls(code)
        first_line = self._line
        self._line += lines
        if not self._is_active:
            return "\n" * lines
        expanded = self.macros.expand(_SPLICED.sub(_join_continued, code))
        self._note_oversized(first_line)
        return expanded

    def _note_oversized(self, first_line: int) -> None:
        for name, line in self.macros.oversized:
            self._problem(f"{name} expands to too much text; not expanded", first_line + line)
        self.macros.oversized.clear()

    def _note_calls(self, code: str) -> None:
        """Remember the calls in open branches that would make endpoints."""
        found = ENDPOINT_CALL.search(code)
        if found is None:
            return
        for branch in self._branches:
            if not branch.is_active:
                line = self._line + code.count("\n", 0, found.start())
                branch.lost_call = branch.lost_call or (found.group(), line, branch.condition)
                return
            branch.has_calls = True

    @property
    def _is_active(self) -> bool:
        return not self._branches or self._branches[-1].is_active

    def _directive(self, text: str) -> None:
        plain = _COMMENT.sub(_without_comment, text.replace("\\\n", " "))
        found = _DIRECTIVE.match(plain)
        name, rest = (found[1], found[2].strip()) if found else ("", "")
        if name in self._CONDITIONS:
            self._CONDITIONS[name](self, rest)
        elif self._is_active and name in self._ACTIONS:
            self._ACTIONS[name](self, rest)
        self._note_oversized(self._line)

    def _problem(self, why: str, line: int = 0) -> None:
        self.problems.append(SourceProblem(line or self._line, why))

    def _define(self, rest: str) -> None:
        found = _DEFINE.match(rest)
        if found:
            params = None if found[2] is None else _params(found[2])
            self.macros.defined[found[1]] = Macro(found[3].strip(), params, self._line)

    def _undef(self, rest: str) -> None:
        self.macros.defined.pop(rest, None)

    def _include(self, rest: str) -> None:
        self.includes.append(rest if rest[:1] in {"<", '"'} else self.macros.expand(rest))

    def _if(self, rest: str) -> None:
        self._open_branch(lambda: self._is_true(rest), rest)

    def _ifdef(self, rest: str) -> None:
        self._open_branch(lambda: _first_word(rest) in self.macros.defined, rest)

    def _ifndef(self, rest: str) -> None:
        self._open_branch(lambda: _first_word(rest) not in self.macros.defined)

    def _open_branch(self, test: Callable[[], bool], condition: str = "") -> None:
        outer = self._is_active
        live = outer and test()
        self._branches.append(_Branch(live, live or not outer, self._line, condition))

    def _elif(self, rest: str) -> None:
        self._switch_branch("#elif", lambda: self._is_true(rest), rest)

    def _else(self, _rest: str) -> None:
        self._switch_branch("#else", lambda: True)

    def _switch_branch(self, name: str, test: Callable[[], bool], condition: str = "") -> None:
        if not self._branches:
            self._problem(f"{name} without #if")
            return
        branch = self._branches[-1]
        branch.is_active = not branch.was_taken and test()
        branch.was_taken |= branch.is_active
        branch.condition = condition

    def _endif(self, _rest: str) -> None:
        if self._branches:
            self._note_lost_call(self._branches.pop())
        else:
            self._problem("#endif without #if")

    def _note_lost_call(self, branch: _Branch) -> None:
        """Note a call that no branch has instead, and that a macro nobody defines leaves out."""
        if branch.lost_call is None or branch.has_calls or not self._is_active:
            return
        call, line, condition = branch.lost_call
        names = set(_MACRO_NAME.findall(condition)) - self.macros.defined.keys() - _OTHER_PLATFORMS
        if names:
            missing = ", ".join(sorted(names))
            self._problem(f"a call of {call} is left out: {missing} is not defined", line)

    def _is_true(self, rest: str) -> bool:
        try:
            return is_true(rest, self.macros)
        except ValueError as error:
            self._problem(f"#if {rest[:60]}: {error}")
            return False

    _CONDITIONS: ClassVar[dict[str, Callable[["_DirectiveReader", str], None]]] = {
        "if": _if,
        "ifdef": _ifdef,
        "ifndef": _ifndef,
        "elif": _elif,
        "else": _else,
        "endif": _endif,
    }
    _ACTIONS: ClassVar[dict[str, Callable[["_DirectiveReader", str], None]]] = {
        "define": _define,
        "undef": _undef,
        "include": _include,
    }


def _join_continued(found: re.Match[str]) -> str:
    """Return a line that goes on behind a backslash as one line, its newlines behind it."""
    return found.group().replace("\\\n", "") + "\n" * found.group().count("\\\n")


def _params(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _first_word(text: str) -> str:
    return text.split(maxsplit=1)[0] if text else ""


def _without_comment(found: re.Match[str]) -> str:
    return " " if found["comment"] else found.group()
