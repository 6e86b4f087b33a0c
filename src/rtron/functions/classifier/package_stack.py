"""Repositories of several packages: what the packages together tell."""

from __future__ import annotations

from collections import Counter
from math import sqrt
from typing import TYPE_CHECKING

from rtron.functions.classifier.scores import Scores
from rtron.functions.domains import DOMAIN_OF
from rtron.functions.text.names import name_tokens
from rtron.vocabulary import Domain, FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

_SUPPORT: dict[FunctionType, float] = {
    FunctionType.MOBILE: 3.1,
    FunctionType.MANIPULATOR: 3.1,
    FunctionType.VISUALIZATION: 2.2,
    FunctionType.SUPPORT: 2.0,
    FunctionType.EXTENSION: 1.8,
}
_OTHER_SUPPORT = 2.5
_ROBOTS = (FunctionType.MOBILE, FunctionType.MANIPULATOR)
_MESSAGES = (("msgs",), ("srvs",), ("messages",), ("interfaces",))
_CLEARLY = 4.1
_MANY = 0.4
_SOME = 0.2
_NEARLY = 0.85


def functional(packages: Mapping[str, Scores]) -> Mapping[str, Scores]:
    """Return the packages that are not messages or tests only, or all if there are no others."""
    own = {n: s for n, s in packages.items() if not _is_messages(n) and not _is_test(n)}
    return own or packages


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
        others = [type for type, count in counts if count >= _least(type, primary) * len(packages)]
    else:
        ranked = weighed.ranked(_threshold(weighed))
        others = [type for type in ranked if type is not FunctionType.EXTENSION]
    return (primary, *(type for type in others if type != primary))


def _tops(packages: Iterable[Scores]) -> Counter[FunctionType]:
    """Count what each package tells most strongly; a robot's name tells nothing of a package."""
    ranked = ((scores, type) for scores in packages for type in scores.ranked()[:1])
    return Counter(
        type for scores, type in ranked if type not in _ROBOTS or scores.weights[type] >= _CLEARLY
    )


def _clear(packages: Iterable[Scores]) -> Counter[FunctionType]:
    return Counter(type for scores in packages for type in _clearly(scores))


def _clearly(scores: Scores) -> Iterator[FunctionType]:
    """Yield a package's clear types; an Extension is one only if nothing else is clearer."""
    for at, type in enumerate(scores.ranked(_threshold(scores))):
        if at == 0 or type is not FunctionType.EXTENSION:
            yield type


def _threshold(scores: Scores) -> float:
    return max(_CLEARLY, _NEARLY * max(scores.weights.values(), default=0.0))


def _least(type: FunctionType, primary: FunctionType) -> float:
    """Return the share of its packages that a stack needs to have a type.

    The robot that a stack is only for, its tools and a GUI beside it are no functions of it.
    """
    if type in _ROBOTS or type is FunctionType.EXTENSION:
        return _MANY
    beside = type is FunctionType.VISUALIZATION and DOMAIN_OF[primary] is not Domain.DRIVERS
    return _SOME if beside else 0.0


def _is_messages(package: str) -> bool:
    return name_tokens(package).words[-1:] in _MESSAGES


def _is_test(package: str) -> bool:
    stems = name_tokens(package).stems
    return "test" in (*stems[:1], *stems[-1:])
