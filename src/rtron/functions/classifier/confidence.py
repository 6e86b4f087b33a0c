"""How sure each function of a repository is: a logistic regression on what its pieces tell.

Three features: the share of all evidence that speaks for the function, how much speaks for it, and
whether it is one of those that readers tell apart in different ways. How much they count is learned
from repositories labelled by hand: `confidence.yaml`, written by
`python -m evaluation.common.function_confidence --write`.
"""

from __future__ import annotations

from functools import cache
from math import exp
from typing import TYPE_CHECKING

from rtron.functions.package_data import load_package_yaml
from rtron.vocabulary import FunctionType

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtron.functions.classifier.result import InformationSource
    from rtron.functions.classifier.scores import FunctionScores

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
