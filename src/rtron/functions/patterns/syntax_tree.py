"""What a pattern is made of. Each part tells where it may end when it begins at a token."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from rtron.errors import InputError
from rtron.functions.text import Tokens, stem

if TYPE_CHECKING:
    import re
    from collections.abc import Iterable, Iterator

    from rtron.functions.text import Tokens


class PatternNode(Protocol):
    """A part of a pattern."""

    @abstractmethod
    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield each index after a match that begins at `start`."""


@dataclass(frozen=True, slots=True)
class StemSet:
    """A word whose stem is one of these."""

    stems: frozenset[str]

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the index after the word."""
        if start < len(tokens.stems) and tokens.stems[start] in self.stems:
            yield start + 1


@dataclass(frozen=True, slots=True)
class ExactWord:
    """One word, and none of its variants."""

    word: str

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the index after the word."""
        if start < len(tokens.words) and tokens.words[start] == self.word:
            yield start + 1


@dataclass(frozen=True, slots=True)
class WordGlob:
    """A word that begins or ends so."""

    shape: re.Pattern[str]

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the index after the word."""
        if start < len(tokens.words) and self.shape.fullmatch(tokens.words[start]):
            yield start + 1


@dataclass(frozen=True, slots=True)
class Alternation:
    """Any one of these."""

    options: tuple[PatternNode, ...]

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the indices after each option."""
        for option in self.options:
            yield from option.match_ends(tokens, start)


@dataclass(frozen=True, slots=True)
class PatternSequence:
    """These, one after the other."""

    items: tuple[PatternNode, ...]

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the indices after the last item."""
        return self._match_from(0, tokens, start)

    def _match_from(self, item: int, tokens: Tokens, start: int) -> Iterator[int]:
        if item == len(self.items):
            yield start
            return
        for end in self.items[item].match_ends(tokens, start):
            yield from self._match_from(item + 1, tokens, end)


@dataclass(frozen=True, slots=True)
class OptionalPattern:
    """An item, or nothing."""

    item: PatternNode

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the indices after the item, and the start."""
        yield from self.item.match_ends(tokens, start)
        yield start


@dataclass(frozen=True, slots=True)
class WordGap:
    """At most so many words, whatever they are."""

    most: int

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the start and the indices after one word, two, … ."""
        yield from range(start, min(start + self.most, len(tokens.words)) + 1)


@dataclass(frozen=True, slots=True)
class Anchor:
    """The first word's beginning, or the last word's end."""

    is_end: bool

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the start if it is there."""
        if start == (len(tokens.words) if self.is_end else 0):
            yield start


@dataclass(frozen=True, slots=True)
class NegativeLookahead:
    """An item that does not begin here."""

    item: PatternNode

    def match_ends(self, tokens: Tokens, start: int) -> Iterator[int]:
        """Yield the start unless the item matches there."""
        if not matches_at(self.item, tokens, start):
            yield start


def matches_at(node: PatternNode, tokens: Tokens, start: int) -> bool:
    """Tell whether a node matches at a token."""
    return next(node.match_ends(tokens, start), None) is not None


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
