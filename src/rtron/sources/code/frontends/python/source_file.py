"""What lowering a file carries along."""

import ast
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rtron.sources.code.ir import SourceProblem, Stmt

_MAX_DEPTH = 100
_TEXT = 60


@dataclass(slots=True, kw_only=True)
class SourceFile:
    """The file that is being lowered.

    `preceding` collects what an expression does before its statement runs (`:=`, `yield`), which is
    known only where it is surely evaluated (`is_unconditional`). Nesting beyond 100 levels is a
    problem.
    """

    file: str
    lines: list[bytes]
    problems: list[SourceProblem] = field(default_factory=list)
    preceding: list[Stmt] = field(default_factory=list)
    is_unconditional: bool = True
    depth: int = 0

    def is_too_deep(self, line: int) -> bool:
        """Whether a node lies deeper than we go; note the problem, once a line."""
        if self.depth < _MAX_DEPTH:
            return False
        problem = SourceProblem(line, "nested too deep, left out")
        if problem not in self.problems[-1:]:
            self.problems.append(problem)
        return True

    def snippet(self, node: ast.expr) -> str:
        """Return the text of an expression, cut short, of its first line only."""
        line = self.lines[node.lineno - 1]
        end = node.end_col_offset if node.end_lineno == node.lineno else len(line)
        return line[node.col_offset : end].decode("utf-8", "replace")[:_TEXT]

    @contextmanager
    def conditional(self) -> Iterator[None]:
        """Within: an expression that may be evaluated never, or many times."""
        sure, self.is_unconditional = self.is_unconditional, False
        try:
            yield
        finally:
            self.is_unconditional = sure
