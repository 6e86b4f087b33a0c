"""How strongly texts tell each function type."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rtron.functions.classifier.result import InformationSource, RuleEvidence
from rtron.functions.rules.code_rules import match_code, package_facts
from rtron.functions.rules.loader import load_rule_index

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.patterns.index import PatternMatch
    from rtron.functions.repository import SourcePackage
    from rtron.functions.rules.code_rules import CodeMatch
    from rtron.functions.rules.rule import FunctionRule
    from rtron.functions.text.tokens import Tokens
    from rtron.vocabulary import FunctionType

MIN_WEIGHT = 3.0


@dataclass(frozen=True, slots=True)
class FunctionScores:
    """The weight found for each type, and what was found."""

    weights: dict[FunctionType, float] = field(default_factory=dict)
    evidence: tuple[RuleEvidence, ...] = ()

    def ranked(self, min_weight: float = MIN_WEIGHT) -> tuple[FunctionType, ...]:
        """Return the types told strongly enough, the strongest first."""
        types = [type for type, weight in self.weights.items() if weight >= min_weight]
        return tuple(sorted(types, key=lambda types: -self.weights[types]))

    def scaled(self, factor: float) -> FunctionScores:
        """Return the same evidence with its weights times a factor."""
        return FunctionScores({t: w * factor for t, w in self.weights.items()}, self.evidence)

    def __add__(self, other: FunctionScores) -> FunctionScores:
        weights = dict(self.weights)
        for type, weight in other.weights.items():
            weights[type] = weights.get(type, 0.0) + weight
        return FunctionScores(weights, self.evidence + other.evidence)


def score_texts(
    texts: Iterable[tuple[Tokens, float]], source: InformationSource, package: str = ""
) -> FunctionScores:
    """Return what the rules find in texts, each of which counts so much; a rule counts once."""
    evidence: dict[str, RuleEvidence] = {}
    weights: dict[FunctionType, float] = defaultdict(float)
    for tokens, factor in texts:
        for match in _unvetoed_matches(tokens, source):
            rule = match.value
            if rule.id not in evidence:
                words = " ".join(tokens.words[match.start : match.end])
                evidence[rule.id] = RuleEvidence(
                    source=source, text=words, rule=rule.id, type=rule.type, package=package
                )
                weights[rule.type] += rule.weight * factor
    return FunctionScores(dict(weights), tuple(evidence.values()))


def score_code(matches: Iterable[CodeMatch], package: str = "") -> FunctionScores:
    """Return what the rules on code tell that match."""
    scores = FunctionScores()
    for match in matches:
        rule = match.rule
        evidence = RuleEvidence(
            source=InformationSource.CODE,
            text=match.text,
            rule=rule.id,
            type=rule.type,
            package=package,
        )
        scores += FunctionScores({rule.type: rule.weight}, (evidence,))
    return scores


def score_package_code(package: SourcePackage) -> FunctionScores:
    """Return what the code of a package tells."""
    return score_code(match_code(package_facts(package)), package.name)


def _unvetoed_matches(
    tokens: Tokens, source: InformationSource
) -> Iterator[PatternMatch[FunctionRule]]:
    vetoed: dict[str, bool] = {}
    for match in load_rule_index().find(tokens):
        rule = match.value
        if source not in rule.sources:
            continue
        if rule.id not in vetoed:
            vetoed[rule.id] = rule.is_vetoed(tokens)
        if not vetoed[rule.id]:
            yield match
