"""Repositories of several packages: what the packages together tell."""

from __future__ import annotations

from collections import Counter
from math import sqrt
from typing import TYPE_CHECKING

from rtron.functions.classifier.scores import FunctionScores, score_code, score_package_code
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.rules.code_rules import match_code, package_facts
from rtron.functions.text import name_tokens
from rtron.vocabulary import Domain, FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from rtron.functions.repository import SourcePackage

_PACKAGE_WEIGHT: dict[FunctionType, float] = {
    FunctionType.MOBILE: 3.1,
    FunctionType.MANIPULATOR: 3.1,
    FunctionType.VISUALIZATION: 2.2,
    FunctionType.SUPPORT: 2.0,
    FunctionType.EXTENSION: 1.8,
}
_OTHER_PACKAGE_WEIGHT = 2.5
_ROBOTS = (FunctionType.MOBILE, FunctionType.MANIPULATOR)
_MESSAGES = (("msgs",), ("srvs",), ("messages",), ("interfaces",))
_CLEAR_WEIGHT = 4.1
_LARGE_SHARE = 0.4
_SMALL_SHARE = 0.2
_NEAR_TOP_SHARE = 0.85


def functional_packages(packages: Mapping[str, FunctionScores]) -> Mapping[str, FunctionScores]:
    """Return the packages that are not messages or tests only, or all if there are no others."""
    kept_packages = {n: s for n, s in packages.items() if not _is_messages(n) and not _is_test(n)}
    return kept_packages or packages


def score_packages(packages: Iterable[FunctionScores]) -> FunctionScores:
    """Return what the packages of a repository tell, each by what it tells most strongly."""
    listed = tuple(packages)
    top_counts = _top_type_counts(listed)
    weights = {
        t: _PACKAGE_WEIGHT.get(t, _OTHER_PACKAGE_WEIGHT) * sqrt(n) for t, n in top_counts.items()
    }
    return FunctionScores(weights, tuple(e for package in listed for e in package.evidence))


def score_repository_code(packages: Sequence[SourcePackage]) -> FunctionScores:
    """Return what the code of a repository's packages tells, each and together."""
    by_name = functional_packages({each.name: score_package_code(each) for each in packages})
    by_package = sum(by_name.values(), FunctionScores())
    all_facts = frozenset[str]().union(*map(package_facts, packages))
    together = score_code(match_code(all_facts, of_repository=True))
    return by_package.scaled(1 / sqrt(len(by_name) or 1)) + together


def repository_functions(
    primary: FunctionType, scores: FunctionScores, packages: Mapping[str, FunctionScores]
) -> tuple[FunctionType, ...]:
    """Return the first type and the others that the repository or a package of it clearly has."""
    if packages and all(map(_is_messages, packages)):
        others = []
    elif len(packages) > 1:
        counts = _clear_type_counts(packages.values()).most_common()
        others = [
            type for type, count in counts if count >= _min_share(type, primary) * len(packages)
        ]
    else:
        ranked = scores.ranked(_clear_threshold(scores))
        others = [type for type in ranked if type is not FunctionType.EXTENSION]
    return (primary, *(type for type in others if type != primary))


def _top_type_counts(packages: Iterable[FunctionScores]) -> Counter[FunctionType]:
    """Count what each package tells most strongly; a robot's name tells nothing of a package."""
    ranked = ((scores, type) for scores in packages for type in scores.ranked()[:1])
    return Counter(
        type
        for scores, type in ranked
        if type not in _ROBOTS or scores.weights[type] >= _CLEAR_WEIGHT
    )


def _clear_type_counts(packages: Iterable[FunctionScores]) -> Counter[FunctionType]:
    return Counter(type for scores in packages for type in _clear_types(scores))


def _clear_types(scores: FunctionScores) -> Iterator[FunctionType]:
    """Yield a package's clear types; an Extension is one only if nothing else is clearer."""
    for at, type in enumerate(scores.ranked(_clear_threshold(scores))):
        if at == 0 or type is not FunctionType.EXTENSION:
            yield type


def _clear_threshold(scores: FunctionScores) -> float:
    return max(_CLEAR_WEIGHT, _NEAR_TOP_SHARE * max(scores.weights.values(), default=0.0))


def _min_share(type: FunctionType, primary: FunctionType) -> float:
    """Return the share of its packages that a stack needs to have a type.

    The robot that a stack is only for, its tools and a GUI beside it are no functions of it, nor
    is what one of many libraries is for. The controllers of an arm belong to its driver.
    """
    is_of_arm = (primary, type) == (FunctionType.MANIPULATOR, FunctionType.PATH_TRACKING)
    if type in _ROBOTS or type is FunctionType.EXTENSION or is_of_arm:
        return _LARGE_SHARE
    is_beside = type is FunctionType.VISUALIZATION and DOMAIN_BY_TYPE[primary] is not Domain.DRIVERS
    return _SMALL_SHARE if is_beside or primary is FunctionType.EXTENSION else 0.0


def _is_messages(package: str) -> bool:
    return name_tokens(package).words[-1:] in _MESSAGES


def _is_test(package: str) -> bool:
    stems = name_tokens(package).stems
    return "test" in (*stems[:1], *stems[-1:])
