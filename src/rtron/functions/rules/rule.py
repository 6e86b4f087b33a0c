"""A rule: words that tell a function type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.patterns.syntax_tree import matches

if TYPE_CHECKING:
    from rtron.functions.classifier.result import Piece
    from rtron.functions.patterns.syntax_tree import Node
    from rtron.functions.text.tokens import Tokens
    from rtron.vocabulary import FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """Tells a type where a pattern matches in a piece that counts, and no veto does.

    `weight` is from 1, a hint, over 3, enough alone, to 9: stronger than what else is there.
    `matches` and `excludes` are examples, which tests run.
    """

    id: str
    type: FunctionType
    weight: float
    patterns: tuple[Node, ...]
    pieces: frozenset[Piece]
    vetoes: tuple[Node, ...] = ()
    matches: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()

    def fits(self, tokens: Tokens) -> bool:
        """Tell whether a pattern matches in a name or sentence, and no veto does."""
        return _anywhere(self.patterns, tokens) and not self.vetoed(tokens)

    def vetoed(self, tokens: Tokens) -> bool:
        """Tell whether a veto matches anywhere in a name or sentence."""
        return _anywhere(self.vetoes, tokens)


def _anywhere(nodes: tuple[Node, ...], tokens: Tokens) -> bool:
    starts = range(len(tokens.words))
    return any(matches(node, tokens, start) for node in nodes for start in starts)
