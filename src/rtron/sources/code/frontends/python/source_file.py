"""What lowering a file carries along."""

import ast
from collections import Counter
from dataclasses import dataclass, field

from rtron.sources.code.ir import SourceProblem, Stmt

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
    problems: list[SourceProblem] = field(default_factory=list)
    preceding: list[Stmt] = field(default_factory=list)
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
        problem = SourceProblem(line, "nested too deep, left out")
        if problem not in self.problems[-1:]:
            self.problems.append(problem)
        return True

    def snippet(self, node: ast.expr) -> str:
        """Return the text of an expression, cut short, of its first line only."""
        line = self.lines[node.lineno - 1]
        end = node.end_col_offset if node.end_lineno == node.lineno else len(line)
        return line[node.col_offset : end].decode("utf-8", "replace")[:_TEXT]
