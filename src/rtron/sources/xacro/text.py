"""A text of a description with `${…}` and `$(…)` in it (ROS wiki: xacro, substitution)."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.launch.common.expression_library import Value
from rtron.sources.xacro.budget import Budget

Part: TypeAlias = tuple[str, str]

_TOKEN = re.compile(
    r"\$(?P<escaped>\$+[{(])|\$\{(?P<expression>[^}]*)\}|\$\((?P<command>[^)]*)\)"
    r"|(?P<text>[^$]+|\$[^{($]+|\$$)"
)


@dataclass(frozen=True, slots=True)
class Text:
    """Evaluates texts: `expression` and `command` say what stands in `${…}` and in `$(…)`.

    Both raise ValueError, UnresolvableError or MissingArgumentError; so does `value`.
    """

    expression: Callable[[str], Value]
    command: Callable[[str], str]
    budget: Budget

    def value(self, text: str) -> Value:
        """Return a text's value: a single expression keeps its type, everything else is joined."""
        if "$" not in text:
            return text
        values = [self._part(kind, part) for kind, part in _parts(text)]
        self.budget.step(len(values))
        if len(values) == 1:
            return values[0]
        pieces = [str(value) for value in values]
        self.budget.text(sum(map(len, pieces)))
        return "".join(pieces)

    def _part(self, kind: str, part: str) -> Value:
        if kind == "expression":
            return self.expression(str(self.value(part)))
        if kind == "command":
            return self.command(f"$({self.value(part)})")
        return part


def _parts(text: str) -> Iterator[Part]:
    place = 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise ValueError(f"`{text[place : place + 40]}` is no expression")
        yield str(match.lastgroup), str(match[str(match.lastgroup)])
        place = match.end()
