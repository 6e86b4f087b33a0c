"""Broken statements are taken out of a text; all others keep their lines."""

import re
from bisect import bisect_right
from typing import NamedTuple

from rtron.sources.code.frontends.python.tokenizer import indentation, statements
from rtron.sources.code.ir import Problem

_HEAD_WITHOUT_BODY = re.compile(r"expected an indented block.* on line (\d+)")


class Span(NamedTuple):
    """The lines, counted from 1, of statements that share them; their indentation and tokens."""

    first: int
    last: int
    indent: int
    size: int


class Blanks:
    """A text some of whose statements are blanked; `problems` has one for each."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self._spans = _spans(text)
        self._firsts = [span.first for span in self._spans]
        self._blanked: set[int] = set()
        self.problems: list[Problem] = []

    def text(self) -> str:
        """Return the text as it is by now."""
        return "\n".join(self._lines)

    def blank(self, error: SyntaxError) -> None:
        """Take out the statement at which Python stopped, with the block below it."""
        place = self._place(error)
        while place > 0 and place in self._blanked:
            place -= 1
        if not self._spans or place in self._blanked:
            self.blank_from(error)
            return
        keep_place = not isinstance(error, IndentationError) or "too many levels" in error.msg
        self._problem(self._spans[place].first, error, "left out")
        self._blank_block(place, keep_place=keep_place)

    def blank_from(self, error: SyntaxError) -> None:
        """Take out everything from the line on at which Python stopped."""
        line = max(error.lineno or 1, 1)
        self._problem(line, error, "all from here is left out")
        self._blank_lines(line, len(self._lines))

    def _place(self, error: SyntaxError) -> int:
        head = _HEAD_WITHOUT_BODY.match(error.msg)
        line = int(head[1]) if head else error.lineno
        if line is None:
            return self._longest()
        return max(bisect_right(self._firsts, line) - 1, 0)

    def _longest(self) -> int:
        left = [place for place in range(len(self._spans)) if place not in self._blanked]
        return max(left, key=lambda place: self._spans[place].size, default=0)

    def _blank_block(self, place: int, *, keep_place: bool) -> None:
        first, last, indent, _ = self._spans[place]
        self._blanked.add(place)
        for below in range(place + 1, len(self._spans)):
            if self._spans[below].indent <= indent:
                break
            self._blanked.add(below)
            last = self._spans[below].last
        self._blank_lines(first, last)
        if keep_place:
            self._lines[first - 1] = " " * indent + "pass"

    def _blank_lines(self, first: int, last: int) -> None:
        self._lines[first - 1 : last] = [""] * (min(last, len(self._lines)) - first + 1)

    def _problem(self, line: int, error: SyntaxError, what: str) -> None:
        self.problems.append(Problem(line, f"{what}: {error.msg}"))


def _spans(text: str) -> list[Span]:
    spans: list[Span] = []
    for tokens in statements(text):
        indent = len(indentation(text, tokens[0]).expandtabs(8))
        span = Span(tokens[0].line, tokens[-1].last_line, indent, len(tokens))
        if spans and span.first <= spans[-1].last:
            before = spans.pop()
            last, size = max(before.last, span.last), before.size + span.size
            span = Span(before.first, last, before.indent, size)
        spans.append(span)
    return spans
