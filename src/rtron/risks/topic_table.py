"""Ordered tables that give a topic its word by message type and name; the first match decides."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from rtron.vocabulary import normalise_type

_TYPE_CACHE_SIZE = 4096
_ANYTHING = ("*",)
# No name in ROS is longer, and an expression takes time in the square of a hostile one.
_LONGEST_NAME = 1000


class NamePatterns:
    """Names, whole or with `*` for anything, that a text can match; most need no regex."""

    __slots__ = ("_exact", "_prefixes", "_suffixes", "_wildcards")

    def __init__(self, patterns: Iterable[str]) -> None:
        written = frozenset(patterns)
        self._exact = frozenset(name for name in written if "*" not in name)
        with_wildcard = written - self._exact
        prefixes = {name for name in with_wildcard if name.index("*") == len(name) - 1}
        suffixes = {name for name in with_wildcard - prefixes if name.rindex("*") == 0}
        self._prefixes = tuple(name[:-1] for name in prefixes)
        self._suffixes = tuple(name[1:] for name in suffixes)
        others = sorted(map(_regex, with_wildcard - prefixes - suffixes))
        self._wildcards = re.compile("|".join(others)) if others else None

    def match(self, text: str) -> bool:
        """Tell whether one of the patterns matches the whole text."""
        if text in self._exact or text.startswith(self._prefixes) or text.endswith(self._suffixes):
            return True
        if self._wildcards is None or len(text) > _LONGEST_NAME:
            return False
        return self._wildcards.search(text) is not None


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicTableEntry:
    """One of `types` and one of `topics` must match; an empty tuple asks for nothing."""

    category: str
    types: tuple[str, ...] = ()
    topics: tuple[str, ...] = ()


class TopicTable:
    """Entries in order. Which of them a type can match at all is kept, as types are few."""

    def __init__(self, entries: Iterable[TopicTableEntry]) -> None:
        self._entries = [
            (
                NamePatterns(map(normalise_type, entry.types or _ANYTHING)),
                NamePatterns(entry.topics or _ANYTHING),
                entry.category,
            )
            for entry in entries
        ]
        self._candidates = lru_cache(_TYPE_CACHE_SIZE)(self._find_candidates)

    def find(self, message_type: str, topic: str) -> str | None:
        """Return the word of the first entry that matches, or None."""
        for names, word in self._candidates(message_type):
            if names.match(topic):
                return word
        return None

    def _find_candidates(self, message_type: str) -> list[tuple[NamePatterns, str]]:
        return [(names, word) for types, names, word in self._entries if types.match(message_type)]


def _regex(pattern: str) -> str:
    """Write a pattern for `search`: a `*` at either end then costs nothing."""
    parts = "(?s:.*)".join(map(re.escape, pattern.strip("*").split("*")))
    start = "" if pattern.startswith("*") else r"\A"
    end = "" if pattern.endswith("*") else r"\Z"
    return f"{start}{parts}{end}"
