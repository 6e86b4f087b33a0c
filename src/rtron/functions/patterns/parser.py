"""Patterns written as text.

laser scanner         these words, in any variant (scanners, scanning, …)
=scan                 this word, as it is
*lidar  rqt*          a word that ends, begins so
(camera | lidar)      one of these
driver?               or nothing
..3                   at most three words, whatever they are
!(simulated | fake)   not these here
^  $                  the beginning, the end of the name or sentence
@sensor               one of a named list
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtron.errors import InputError
from rtron.functions.patterns.syntax_tree import (
    Alternation,
    Anchor,
    ExactWord,
    NegativeLookahead,
    OptionalPattern,
    PatternNode,
    PatternSequence,
    StemSet,
    WordGap,
    WordGlob,
)
from rtron.functions.text import stem

if TYPE_CHECKING:
    from collections.abc import Mapping

_TOKEN = re.compile(r"\s*(\.\.[1-9]|[()|?!^$]|@[a-z_]+|=[a-z0-9]+|\*?[a-z0-9]+\*?)")
_WORD = re.compile(r"[a-z0-9]+")
_MAX_DEPTH = 8


def parse_pattern(text: str, lists: Mapping[str, PatternNode]) -> PatternNode:
    """Return the pattern a text means, with @lists; raise InputError where it is none."""
    tokens = _tokenize(text)
    parser = _PatternParser(text, tokens, lists)
    node = parser.parse_alternation(0)
    if parser.at != len(tokens):
        raise parser.error(f"`{tokens[parser.at]}` is not expected here")
    return node


def _tokenize(text: str) -> list[str]:
    signs, at, stripped = [], 0, text.rstrip()
    while at < len(stripped):
        match = _TOKEN.match(stripped, at)
        if not match:
            raise InputError(f"pattern {text!r:.80}: cannot read {stripped[at:].strip()!r:.20}")
        signs.append(match[1])
        at = match.end()
    return signs


class _PatternParser:
    def __init__(self, text: str, signs: list[str], lists: Mapping[str, PatternNode]) -> None:
        self._text = text
        self._tokens = signs
        self._lists = lists
        self.at = 0

    def parse_alternation(self, depth: int) -> PatternNode:
        if depth > _MAX_DEPTH:
            raise self.error("nested too deep")
        options = [self._parse_sequence(depth)]
        while self._peek() == "|":
            self.at += 1
            options.append(self._parse_sequence(depth))
        return _alternation(options)

    def error(self, message: str) -> InputError:
        return InputError(f"pattern {self._text!r:.80}: {message}")

    def _peek(self) -> str:
        return self._tokens[self.at] if self.at < len(self._tokens) else ""

    def _parse_sequence(self, depth: int) -> PatternNode:
        items = []
        while self._peek() not in {"", "|", ")"}:
            items.append(self._parse_item(depth))
        if not items:
            raise self.error("a word is missing")
        return items[0] if len(items) == 1 else PatternSequence(tuple(items))

    def _parse_item(self, depth: int) -> PatternNode:
        if self._peek() == "!":
            self.at += 1
            return NegativeLookahead(self._parse_atom(depth))
        atom = self._parse_atom(depth)
        if self._peek() == "?":
            self.at += 1
            return OptionalPattern(atom)
        return atom

    def _parse_atom(self, depth: int) -> PatternNode:
        sign = self._peek()
        self.at += 1
        if sign == "(":
            return self._parse_group(depth)
        if sign.startswith("@"):
            return self._list_reference(sign[1:])
        return self._parse_word(sign)

    def _parse_group(self, depth: int) -> PatternNode:
        inside = self.parse_alternation(depth + 1)
        if self._peek() != ")":
            raise self.error("`)` is missing")
        self.at += 1
        return inside

    def _list_reference(self, name: str) -> PatternNode:
        if name not in self._lists:
            raise self.error(f"there is no list @{name}")
        return self._lists[name]

    def _parse_word(self, sign: str) -> PatternNode:
        if sign in {"^", "$"}:
            return Anchor(sign == "$")
        if sign.startswith(".."):
            return WordGap(int(sign[2:]))
        if sign.startswith("="):
            return ExactWord(sign[1:])
        if "*" in sign:
            return WordGlob(re.compile(sign.replace("*", "[a-z0-9]*")))
        if _WORD.fullmatch(sign):
            return StemSet(frozenset({stem(sign)}))
        raise self.error(f"`{sign}` is not expected here")


def _alternation(options: list[PatternNode]) -> PatternNode:
    words = [option.stems for option in options if isinstance(option, StemSet)]
    others = [option for option in options if not isinstance(option, StemSet)]
    nodes: list[PatternNode] = [StemSet(frozenset().union(*words))] if words else []
    nodes += others
    return nodes[0] if len(nodes) == 1 else Alternation(tuple(nodes))
