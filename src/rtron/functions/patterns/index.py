"""Which of many patterns match: only those are tried whose first word is there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Generic, TypeVar

from rtron.errors import InputError
from rtron.functions.patterns.syntax_tree import Edge, Either, Exactly, Glob, Node, OneOf, Sequence
from rtron.functions.text.tokens import Tokens, stem

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

T = TypeVar("T")

_WORDS_KEPT = 2**15


@dataclass(frozen=True, slots=True)
class Match(Generic[T]):
    """What a pattern stands for, and the words on which it matched."""

    of: T
    start: int
    end: int


class PatternIndex(Generic[T]):
    """Patterns, each standing for something."""

    def __init__(self, patterns: Iterable[tuple[Node, T]]) -> None:
        self._by_stem: dict[str, list[tuple[Node, T]]] = {}
        self._globs: list[tuple[Glob, Node, T]] = []
        for node, of in patterns:
            for first in _firsts(node):
                self._add(first, node, of)
        self._tried = lru_cache(maxsize=_WORDS_KEPT)(self._beginning)

    def find(self, tokens: Tokens) -> Iterator[Match[T]]:
        """Yield each pattern's match at each word, from the first word on."""
        for start, word in enumerate(tokens.words):
            for node, of in self._tried(word, tokens.stems[start]):
                end = next(node.ends(tokens, start), None)
                if end is not None:
                    yield Match(of, start, end)

    def _add(self, first: Node, node: Node, of: T) -> None:
        if isinstance(first, Glob):
            self._globs.append((first, node, of))
        for key in _stems(first):
            self._by_stem.setdefault(key, []).append((node, of))

    def _beginning(self, word: str, key: str) -> tuple[tuple[Node, T], ...]:
        globs = ((node, of) for first, node, of in self._globs if first.shape.fullmatch(word))
        return (*self._by_stem.get(key, ()), *globs)


def _firsts(node: Node) -> Iterator[Node]:
    if isinstance(node, Sequence):
        yield from _firsts(node.items[1 if isinstance(node.items[0], Edge) else 0])
    elif isinstance(node, Either):
        for option in node.options:
            yield from _firsts(option)
    elif isinstance(node, OneOf | Exactly | Glob):
        yield node
    else:
        raise InputError("a pattern begins with a word, a group of words or `^` and a word")


def _stems(first: Node) -> frozenset[str]:
    if isinstance(first, OneOf):
        return first.stems
    return frozenset({stem(first.word)}) if isinstance(first, Exactly) else frozenset()
