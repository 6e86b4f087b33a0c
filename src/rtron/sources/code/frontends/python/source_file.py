"""What lowering a file carries along."""

import ast
import codecs
import re
from collections import Counter
from dataclasses import dataclass, field

from rtron.sources.code import ir

_MAX_DEPTH = 100
_TEXT = 60


@dataclass(slots=True, kw_only=True)
class SourceFile:
    """The file that is being lowered.

    `preceding` collects the `yield`s of an expression, which run before its statement. Nesting
    beyond 100 levels is a problem. `class_name` is that of the class around, empty outside.
    """

    file: str
    lines: list[bytes]
    problems: list[ir.SourceProblem] = field(default_factory=list)
    preceding: list[ir.Stmt] = field(default_factory=list)
    depth: int = 0
    class_name: str = ""
    lambdas: Counter[int] = field(default_factory=Counter)

    def lambda_name(self, line: int) -> str:
        """Return what a lambda is called: those of one line are told apart."""
        self.lambdas[line] += 1
        return "<lambda>" if self.lambdas[line] == 1 else f"<lambda {self.lambdas[line]}>"

    def own_name(self, name: str) -> str:
        """Return a name as Python has it: `__x` is a class's own, `_Class__x` (private names)."""
        is_private = name.startswith("__") and not name.endswith("__")
        plain = self.class_name.lstrip("_")
        return f"_{plain}{name}" if is_private and plain else name

    def is_too_deep(self, line: int) -> bool:
        """Whether a node lies deeper than we go; note the problem, once a line."""
        if self.depth < _MAX_DEPTH:
            return False
        problem = ir.SourceProblem(line, "nested too deep, left out")
        if problem not in self.problems[-1:]:
            self.problems.append(problem)
        return True

    def snippet(self, node: ast.expr) -> str:
        """Return the text of an expression, cut short, of its first line only."""
        line = self.lines[node.lineno - 1]
        end = node.end_col_offset if node.end_lineno == node.lineno else len(line)
        return line[node.col_offset : end].decode("utf-8", "replace")[:_TEXT]


_COOKIE = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*([-\w.]+)")
_BLANK = re.compile(rb"[ \t\f]*(?:#.*)?")
_KNOWN = re.compile(
    r"(?:utf-?8|ascii$|us-ascii$|latin|iso-?8859|cp\d|windows-|gbk$|gb\d|big5|euc|shift|sjis|koi8)"
)


def decode(data: bytes) -> tuple[str, tuple[ir.SourceProblem, ...]]:
    """Return a file's text with a line feed at its line ends, and what was wrong with its bytes.

    Bytes that are not of the file's encoding are read as Latin-1, NUL bytes as spaces: lines
    stay where they are.
    """
    data = data.removeprefix(codecs.BOM_UTF8)
    encoding = _named_encoding(data)
    try:
        text, problems = data.decode(encoding), list[ir.SourceProblem]()
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        text, problems = data.decode("latin-1"), [ir.SourceProblem(line, f"this is not {encoding}")]
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        problems.append(ir.SourceProblem(line, "NUL bytes"))
    return text.replace("\0", " "), tuple(problems)


def _named_encoding(data: bytes) -> str:
    """Return the encoding of the cookie in the first two lines; one we do not know is UTF-8."""
    for line in data.split(b"\n", 2)[:2]:
        if found := _COOKIE.match(line):
            return _codec(found[1].decode("ascii", "replace").lower().replace("_", "-"))
        if not _BLANK.fullmatch(line.rstrip(b"\r")):
            break
    return "utf-8"


def _codec(name: str) -> str:
    if name.startswith(("utf-8", "utf8")) or not _KNOWN.match(name):
        return "utf-8"
    try:
        return codecs.lookup(name).name
    except LookupError:
        return "utf-8"
