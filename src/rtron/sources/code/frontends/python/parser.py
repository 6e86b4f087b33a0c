"""Text becomes Python's own syntax tree.

As Python 3, else as Python 3.12 or Python 2 rewritten, else without what is broken.
The text is parsed, never compiled. Python's parser bounds its own depth.
"""

import ast
import re
import warnings
from bisect import bisect_right
from typing import NamedTuple

from rtron.sources.code.frontends.python.python2_syntax import as_python3
from rtron.sources.code.frontends.python.python312_syntax import as_python311
from rtron.sources.code.frontends.python.tokenizer import indentation, statements
from rtron.sources.code.ir import SourceProblem
from rtron.vocabulary import UnresolvedCause

_HEAD_WITHOUT_BODY = re.compile(r"expected an indented block.* on line (\d+)")


class StatementSpan(NamedTuple):
    """The lines, counted from 1, of statements that share them; their indentation and tokens."""

    first: int
    last: int
    indent: int
    size: int


class RecoverableText:
    """A text some of whose statements are blanked; `problems` has one for each."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self._spans = _spans(text)
        self._firsts = [span.first for span in self._spans]
        self._removed: set[int] = set()
        self.problems: list[SourceProblem] = []

    def text(self) -> str:
        """Return the text as it is by now."""
        return "\n".join(self._lines)

    def remove_statement(self, error: SyntaxError) -> None:
        """Take out the statement at which Python stopped, with the block below it."""
        index = self._statement_at(error)
        while index > 0 and index in self._removed:
            index -= 1
        if not self._spans or index in self._removed:
            self.remove_rest(error)
            return
        keeps_pass = not isinstance(error, IndentationError) or "too many levels" in error.msg
        self._add_problem(self._spans[index].first, error, "left out")
        self._remove_block(index, keeps_pass=keeps_pass)

    def remove_rest(self, error: SyntaxError) -> None:
        """Take out everything from the line on at which Python stopped."""
        line = max(error.lineno or 1, 1)
        self._add_problem(line, error, "all from here is left out")
        self._clear_lines(line, len(self._lines))

    def _statement_at(self, error: SyntaxError) -> int:
        head = _HEAD_WITHOUT_BODY.match(error.msg)
        line = int(head[1]) if head else error.lineno
        if line is None:
            return self._longest()
        return max(bisect_right(self._firsts, line) - 1, 0)

    def _longest(self) -> int:
        left = [index for index in range(len(self._spans)) if index not in self._removed]
        return max(left, key=lambda index: self._spans[index].size, default=0)

    def _remove_block(self, index: int, *, keeps_pass: bool) -> None:
        first, last, indent, _ = self._spans[index]
        self._removed.add(index)
        for below in range(index + 1, len(self._spans)):
            if self._spans[below].indent <= indent:
                break
            self._removed.add(below)
            last = self._spans[below].last
        self._clear_lines(first, last)
        if keeps_pass:
            self._lines[first - 1] = " " * indent + "pass"

    def _clear_lines(self, first: int, last: int) -> None:
        self._lines[first - 1 : last] = [""] * (min(last, len(self._lines)) - first + 1)

    def _add_problem(self, line: int, error: SyntaxError, what: str) -> None:
        why = f"{what}: {error.msg}"
        self.problems.append(SourceProblem(line, why, UnresolvedCause.SYNTAX_ERROR))


def _spans(text: str) -> list[StatementSpan]:
    spans: list[StatementSpan] = []
    for tokens in statements(text):
        indent = len(indentation(text, tokens[0]).expandtabs(8))
        span = StatementSpan(tokens[0].line, tokens[-1].last_line, indent, len(tokens))
        if spans and span.first <= spans[-1].last:
            before = spans.pop()
            last, size = max(before.last, span.last), before.size + span.size
            span = StatementSpan(before.first, last, before.indent, size)
        spans.append(span)
    return spans


_MAX_REPAIRS = 3
_MAX_ERRORS = 60
_MAX_PARSED = 4 * 2**20


def parse(text: str) -> tuple[ast.Module, tuple[SourceProblem, ...]]:
    """Return the tree of a text whose lines end with a line feed, and what had to be left out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(_MAX_REPAIRS):
            tree = _try_parse(text)
            if isinstance(tree, ast.Module):
                return tree, ()
            repaired = as_python3(as_python311(text))
            if repaired == text:
                break
            text = repaired
        return _parse_recovering(RecoverableText(text), len(text))


def _try_parse(text: str) -> ast.Module | SyntaxError:
    """Parse; whatever Python's parser cannot bear is a syntax error, perhaps without a line."""
    try:
        return ast.parse(text)
    except SyntaxError as error:
        return error
    except (RecursionError, MemoryError, ValueError):
        return SyntaxError("nested too deep for Python itself")


def _parse_recovering(
    blanks: RecoverableText, size: int
) -> tuple[ast.Module, tuple[SourceProblem, ...]]:
    """Blank one statement after another until Python reads the rest, or what stands before."""
    attempts = min(_MAX_ERRORS, 1 + _MAX_PARSED // (size + 1))
    for left in reversed(range(attempts)):
        tree = _try_parse(blanks.text())
        if isinstance(tree, ast.Module):
            return tree, tuple(blanks.problems)
        if left:
            blanks.remove_statement(tree)
        else:
            blanks.remove_rest(tree)
    tree = _try_parse(blanks.text())
    if isinstance(tree, SyntaxError):
        tree = ast.Module(body=[], type_ignores=[])
        blanks.problems.append(SourceProblem(0, "too many errors, not read"))
    return tree, tuple(blanks.problems)
