"""Words in a row, with their stems."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import snowballstemmer  # type: ignore[import-untyped]

if TYPE_CHECKING:
    from collections.abc import Iterable

_STEMMER = snowballstemmer.stemmer("english")
_CACHE_SIZE = 2**16
_MAX_WORD_LENGTH = 40


@dataclass(frozen=True, slots=True)
class Tokens:
    """A name or a sentence: its words in lower case, and their stems, which patterns compare."""

    words: tuple[str, ...]
    stems: tuple[str, ...]


def tokenize(words: Iterable[str]) -> Tokens:
    """Return words as tokens; a word of more than 40 letters is cut."""
    cut = tuple(word[:_MAX_WORD_LENGTH].lower() for word in words)
    return Tokens(cut, tuple(map(stem, cut)))


@lru_cache(maxsize=_CACHE_SIZE)
def stem(word: str) -> str:
    """Return what a lower-case word has in common with its variants (English, Snowball)."""
    return str(_STEMMER.stemWord(word))
