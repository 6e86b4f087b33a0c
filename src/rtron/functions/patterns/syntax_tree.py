"""What a pattern is made of. Each part tells where it may end when it begins at a token."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import re
    from collections.abc import Iterator

    from rtron.functions.text.tokens import Tokens


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
