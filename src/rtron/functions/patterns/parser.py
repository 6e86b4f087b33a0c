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
    Edge,
    Either,
    Exactly,
    Gap,
    Glob,
    Maybe,
    Node,
    Not,
    OneOf,
    Sequence,
)
from rtron.functions.text.tokens import stem

if TYPE_CHECKING:
    from collections.abc import Mapping

_SIGN = re.compile(r"\s*(\.\.[1-9]|[()|?!^$]|@[a-z_]+|=[a-z0-9]+|\*?[a-z0-9]+\*?)")
_WORD = re.compile(r"[a-z0-9]+")
_DEEPEST = 8


def parse(text: str, lists: Mapping[str, Node]) -> Node:
    """Return the pattern a text means, with @lists; raise InputError where it is none."""
    signs = _signs(text)
    reader = _Reader(text, signs, lists)
    node = reader.either(0)
    if reader.at != len(signs):
        raise reader.wrong(f"`{signs[reader.at]}` is not expected here")
    return node


def _signs(text: str) -> list[str]:
    signs, at, stripped = [], 0, text.rstrip()
    while at < len(stripped):
        found = _SIGN.match(stripped, at)
        if not found:
            raise InputError(f"pattern {text!r:.80}: cannot read {stripped[at:].strip()!r:.20}")
        signs.append(found[1])
        at = found.end()
    return signs


class _Reader:
    def __init__(self, text: str, signs: list[str], lists: Mapping[str, Node]) -> None:
        self._text = text
        self._signs = signs
        self._lists = lists
        self.at = 0

    def either(self, depth: int) -> Node:
        if depth > _DEEPEST:
            raise self.wrong("nested too deep")
        options = [self._sequence(depth)]
        while self._next() == "|":
            self.at += 1
            options.append(self._sequence(depth))
        return _joined(options)

    def wrong(self, message: str) -> InputError:
        return InputError(f"pattern {self._text!r:.80}: {message}")

    def _next(self) -> str:
        return self._signs[self.at] if self.at < len(self._signs) else ""

    def _sequence(self, depth: int) -> Node:
        items = []
        while self._next() not in {"", "|", ")"}:
            items.append(self._item(depth))
        if not items:
            raise self.wrong("a word is missing")
        return items[0] if len(items) == 1 else Sequence(tuple(items))

    def _item(self, depth: int) -> Node:
        if self._next() == "!":
            self.at += 1
            return Not(self._atom(depth))
        atom = self._atom(depth)
        if self._next() == "?":
            self.at += 1
            return Maybe(atom)
        return atom

    def _atom(self, depth: int) -> Node:
        sign = self._next()
        self.at += 1
        if sign == "(":
            return self._group(depth)
        if sign.startswith("@"):
            return self._listed(sign[1:])
        return self._word(sign)

    def _group(self, depth: int) -> Node:
        inside = self.either(depth + 1)
        if self._next() != ")":
            raise self.wrong("`)` is missing")
        self.at += 1
        return inside

    def _listed(self, name: str) -> Node:
        if name not in self._lists:
            raise self.wrong(f"there is no list @{name}")
        return self._lists[name]

    def _word(self, sign: str) -> Node:
        if sign in {"^", "$"}:
            return Edge(sign == "$")
        if sign.startswith(".."):
            return Gap(int(sign[2:]))
        if sign.startswith("="):
            return Exactly(sign[1:])
        if "*" in sign:
            return Glob(re.compile(sign.replace("*", "[a-z0-9]*")))
        if _WORD.fullmatch(sign):
            return OneOf(frozenset({stem(sign)}))
        raise self.wrong(f"`{sign}` is not expected here")


def _joined(options: list[Node]) -> Node:
    words = [option.stems for option in options if isinstance(option, OneOf)]
    others = [option for option in options if not isinstance(option, OneOf)]
    nodes: list[Node] = [OneOf(frozenset().union(*words))] if words else []
    nodes += others
    return nodes[0] if len(nodes) == 1 else Either(tuple(nodes))
