"""A text of a description with `${…}` and `$(…)` in it (ROS wiki: xacro, substitution)."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.budget import EvaluationBudget

Part: TypeAlias = tuple[str, str]

_TOKEN = re.compile(
    r"\$(?P<escaped>\$+[{(])|\$\{(?P<expression>[^}]*)\}|\$\((?P<command>[^)]*)\)"
    r"|(?P<text>[^$]+|\$[^{($]+|\$$)"
)


@dataclass(frozen=True, slots=True)
class TextEvaluator:
    """Evaluates texts: `expression` and `command` say what stands in `${…}` and in `$(…)`.

    Both raise ValueError, UnresolvableError or MissingArgumentError; so does `evaluate`.
    """

    expression: Callable[[str], Value]
    command: Callable[[str], str]
    budget: EvaluationBudget

    def evaluate(self, text: str) -> Value:
        """Return a text's value: a single expression keeps its type, everything else is joined."""
        if "$" not in text:
            return text
        values = [self._evaluate_part(kind, part) for kind, part in _split_parts(text)]
        self.budget.count_steps(len(values))
        if len(values) == 1:
            return values[0]
        pieces = [str(value) for value in values]
        self.budget.count_text(sum(map(len, pieces)))
        return "".join(pieces)

    def _evaluate_part(self, kind: str, part: str) -> Value:
        if kind == "expression":
            return self.expression(str(self.evaluate(part)))
        if kind == "command":
            return self.command(f"$({self.evaluate(part)})")
        return part


def _split_parts(text: str) -> Iterator[Part]:
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise ValueError(f"`{text[position : position + 40]}` is no expression")
        yield str(match.lastgroup), str(match[str(match.lastgroup)])
        position = match.end()
