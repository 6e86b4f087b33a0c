"""How strongly texts tell each function type.

Three features: the share of all evidence that speaks for the function, how much speaks for it, and
whether it is one of those that readers tell apart in different ways. How much they count is learned
from repositories labelled by hand: `confidence.yaml`, written by
`python -m evaluation.common.function_confidence --write`.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from functools import cache
from math import exp
from typing import TYPE_CHECKING

from rtron.functions.classifier.result import InformationSource, RuleEvidence
from rtron.functions.repository import load_package_yaml
from rtron.functions.rules.code_rules import match_code, package_facts
from rtron.functions.rules.loader import load_rule_index
from rtron.vocabulary import FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from rtron.functions.patterns.syntax_tree import PatternMatch
    from rtron.functions.repository import SourcePackage
    from rtron.functions.rules.code_rules import CodeMatch, FunctionRule
    from rtron.functions.text import Tokens

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


_MAX_WEIGHT = 9.0
_MAX_SUPPORT = 2.0
_PRIOR_DOUBT = 0.1
_VAGUE = frozenset({FunctionType.SUPPORT, FunctionType.EXTENSION})
FEATURES = ("constant", "share", "support", "vague")


def function_probabilities(
    functions: Sequence[FunctionType], scores: Mapping[InformationSource, FunctionScores]
) -> Mapping[FunctionType, float]:
    """Return the probability, 0 to 1, that readers give a repository each of these functions.

    That of the first one is the probability that it is right as the first.
    """
    return {
        function: _probability("others" if at else "first", features(function, scores))
        for at, function in enumerate(functions)
    }


def features(
    function: FunctionType, scores: Mapping[InformationSource, FunctionScores]
) -> tuple[float, ...]:
    """Return the features of a function, in the order of `FEATURES`.

    In each piece the strongest other function speaks against it. A full weight counts as 1.
    """
    support = sum(_strength(each.weights.get(function, 0.0)) for each in scores.values())
    doubt = sum(_strength(_strongest_other(function, each)) for each in scores.values())
    share = support / (support + doubt + _PRIOR_DOUBT)
    return (1.0, share, min(support, _MAX_SUPPORT), float(function in _VAGUE))


def _strongest_other(function: FunctionType, scores: FunctionScores) -> float:
    unfit = {function} if function in _VAGUE else {function, *_VAGUE}
    return max((w for other, w in scores.weights.items() if other not in unfit), default=0.0)


def _strength(weight: float) -> float:
    return min(weight, _MAX_WEIGHT) / _MAX_WEIGHT


def _probability(position: str, values: Sequence[float]) -> float:
    learned = _weights()[position]
    total = sum(learned[name] * value for name, value in zip(FEATURES, values, strict=True))
    return 1 / (1 + exp(-total))


@cache
def _weights() -> Mapping[str, Mapping[str, float]]:
    weights: Mapping[str, Mapping[str, float]] = load_package_yaml(
        "rtron.functions.classifier", "confidence.yaml"
    )
    return weights
