"""How strongly texts tell each function type."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rtron.functions.classifier.result import Evidence
from rtron.functions.rules.loader import rule_index

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.classifier.result import Piece
    from rtron.functions.patterns.index import Match
    from rtron.functions.rules.rule import Rule
    from rtron.functions.text.tokens import Tokens
    from rtron.vocabulary import FunctionType

ENOUGH = 3.0


@dataclass(frozen=True, slots=True)
class Scores:
    """The weight found for each type, and what was found."""

    weights: dict[FunctionType, float] = field(default_factory=dict)
    evidence: tuple[Evidence, ...] = ()

    def ranked(self, enough: float = ENOUGH) -> tuple[FunctionType, ...]:
        """Return the types told strongly enough, the strongest first."""
        told = [type for type, weight in self.weights.items() if weight >= enough]
        return tuple(sorted(told, key=lambda told: -self.weights[told]))

    def __add__(self, other: Scores) -> Scores:
        weights = dict(self.weights)
        for type, weight in other.weights.items():
            weights[type] = weights.get(type, 0.0) + weight
        return Scores(weights, self.evidence + other.evidence)


def scores(texts: Iterable[tuple[Tokens, float]], piece: Piece, package: str = "") -> Scores:
    """Return what the rules find in texts, each of which counts so much; a rule counts once."""
    found: dict[str, Evidence] = {}
    weights: dict[FunctionType, float] = defaultdict(float)
    for tokens, factor in texts:
        for match in _matches(tokens, piece):
            rule = match.of
            if rule.id not in found:
                words = " ".join(tokens.words[match.start : match.end])
                found[rule.id] = Evidence(
                    piece=piece, text=words, rule=rule.id, type=rule.type, package=package
                )
                weights[rule.type] += rule.weight * factor
    return Scores(dict(weights), tuple(found.values()))


def _matches(tokens: Tokens, piece: Piece) -> Iterator[Match[Rule]]:
    vetoed: dict[str, bool] = {}
    for match in rule_index().find(tokens):
        rule = match.of
        if piece not in rule.pieces:
            continue
        if rule.id not in vetoed:
            vetoed[rule.id] = rule.vetoed(tokens)
        if not vetoed[rule.id]:
            yield match
