"""A rule: words that tell a function type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.patterns.syntax_tree import matches_at

if TYPE_CHECKING:
    from rtron.functions.classifier.result import InformationSource
    from rtron.functions.patterns.syntax_tree import PatternNode
    from rtron.functions.text.tokens import Tokens
    from rtron.vocabulary import FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionRule:
    """Tells a type where a pattern matches in a piece that counts, and no veto does.

    `weight` is from 1, a hint, over 3, enough alone, to 9: stronger than what else is there.
    `matches_at` and `excludes` are examples, which tests run.
    """

    id: str
    type: FunctionType
    weight: float
    patterns: tuple[PatternNode, ...]
    sources: frozenset[InformationSource]
    vetoes: tuple[PatternNode, ...] = ()
    matches: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()

    def matches_text(self, tokens: Tokens) -> bool:
        """Tell whether a pattern matches in a name or sentence, and no veto does."""
        return _matches_anywhere(self.patterns, tokens) and not self.is_vetoed(tokens)

    def is_vetoed(self, tokens: Tokens) -> bool:
        """Tell whether a veto matches anywhere in a name or sentence."""
        return _matches_anywhere(self.vetoes, tokens)


def _matches_anywhere(nodes: tuple[PatternNode, ...], tokens: Tokens) -> bool:
    starts = range(len(tokens.words))
    return any(matches_at(node, tokens, start) for node in nodes for start in starts)
