"""Which of many patterns match: only those are tried whose first word is there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Generic, TypeVar

from rtron.errors import InputError
from rtron.functions.patterns.syntax_tree import (
    Alternation,
    Anchor,
    ExactWord,
    PatternNode,
    PatternSequence,
    StemSet,
    WordGlob,
)
from rtron.functions.text.tokens import Tokens, stem

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

T = TypeVar("T")

_CACHE_SIZE = 2**15


@dataclass(frozen=True, slots=True)
class PatternMatch(Generic[T]):
    """What a pattern stands for, and the words on which it matched."""

    value: T
    start: int
    end: int


class PatternIndex(Generic[T]):
    """Patterns, each standing for something."""

    def __init__(self, patterns: Iterable[tuple[PatternNode, T]]) -> None:
        self._by_stem: dict[str, list[tuple[PatternNode, T]]] = {}
        self._glob_patterns: list[tuple[WordGlob, PatternNode, T]] = []
        for node, of in patterns:
            for first in _first_words(node):
                self._add(first, node, of)
        self._cached_candidates = lru_cache(maxsize=_CACHE_SIZE)(self._candidates)

    def find(self, tokens: Tokens) -> Iterator[PatternMatch[T]]:
        """Yield each pattern's match at each word, from the first word on."""
        for start, word in enumerate(tokens.words):
            for node, of in self._cached_candidates(word, tokens.stems[start]):
                end = next(node.match_ends(tokens, start), None)
                if end is not None:
                    yield PatternMatch(of, start, end)

    def _add(self, first: PatternNode, node: PatternNode, of: T) -> None:
        if isinstance(first, WordGlob):
            self._glob_patterns.append((first, node, of))
        for key in _stems(first):
            self._by_stem.setdefault(key, []).append((node, of))

    def _candidates(self, word: str, key: str) -> tuple[tuple[PatternNode, T], ...]:
        globs = (
            (node, of) for first, node, of in self._glob_patterns if first.shape.fullmatch(word)
        )
        return (*self._by_stem.get(key, ()), *globs)


def _first_words(node: PatternNode) -> Iterator[PatternNode]:
    if isinstance(node, PatternSequence):
        yield from _first_words(node.items[1 if isinstance(node.items[0], Anchor) else 0])
    elif isinstance(node, Alternation):
        for option in node.options:
            yield from _first_words(option)
    elif isinstance(node, StemSet | ExactWord | WordGlob):
        yield node
    else:
        raise InputError("a pattern begins with a word, a group of words or `^` and a word")


def _stems(first: PatternNode) -> frozenset[str]:
    if isinstance(first, StemSet):
        return first.stems
    return frozenset({stem(first.word)}) if isinstance(first, ExactWord) else frozenset()
