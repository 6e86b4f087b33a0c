"""Repositories of several packages: what the packages together tell."""

from __future__ import annotations

from collections import Counter
from math import sqrt
from typing import TYPE_CHECKING

from rtron.functions.domains import DOMAIN_OF
from rtron.functions.information.names import name_tokens
from rtron.functions.scores import Scores
from rtron.vocabulary import Domain, FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_SUPPORT: dict[FunctionType, float] = {
    FunctionType.MOBILE: 3.1,
    FunctionType.MANIPULATOR: 3.1,
    FunctionType.VISUALIZATION: 2.2,
    FunctionType.SUPPORT: 2.0,
    FunctionType.EXTENSION: 1.8,
}
_OTHER_SUPPORT = 2.5
_ROBOTS = (FunctionType.MOBILE, FunctionType.MANIPULATOR)
_MESSAGES = ("msgs",)
_CLEARLY = 4.0
_MANY = 0.4
_NEARLY = 0.8


def functional(packages: Mapping[str, Scores]) -> Mapping[str, Scores]:
    """Return the packages that are not messages only, or all where there are no others."""
    return {n: s for n, s in packages.items() if not _is_messages(n)} or packages


def stack_scores(packages: Iterable[Scores]) -> Scores:
    """Return what the packages of a repository tell, each by what it tells most strongly."""
    listed = tuple(packages)
    tops = _tops(listed)
    weights = {t: _SUPPORT.get(t, _OTHER_SUPPORT) * sqrt(n) for t, n in tops.items()}
    return Scores(weights, tuple(e for package in listed for e in package.evidence))


def union(
    primary: FunctionType, weighed: Scores, packages: Mapping[str, Scores]
) -> tuple[FunctionType, ...]:
    """Return the first type and the others that the repository or a package of it clearly has."""
    if packages and all(map(_is_messages, packages)):
        others = []
    elif len(packages) > 1:
        counts = _clear(packages.values()).most_common()
        others = [type for type, count in counts if _has(type, primary, count / len(packages))]
    else:
        ranked = weighed.ranked(_threshold(weighed))
        others = [type for type in ranked if type is not FunctionType.EXTENSION]
    return (primary, *(type for type in others if type != primary))


def _tops(packages: Iterable[Scores]) -> Counter[FunctionType]:
    return Counter(ranked[0] for scores in packages if (ranked := scores.ranked()))


def _clear(packages: Iterable[Scores]) -> Counter[FunctionType]:
    return Counter(type for scores in packages for type in scores.ranked(_threshold(scores)))


def _threshold(scores: Scores) -> float:
    return max(_CLEARLY, _NEARLY * max(scores.weights.values(), default=0.0))


def _has(type: FunctionType, primary: FunctionType, share: float) -> bool:
    """Tell whether a stack has a type: the robot that it is for and its tools are not functions."""
    named = DOMAIN_OF[primary] is not Domain.DRIVERS and type in _ROBOTS
    return share >= _MANY or not (named or type is FunctionType.EXTENSION)


def _is_messages(package: str) -> bool:
    return name_tokens(package).stems[-1:] == _MESSAGES
