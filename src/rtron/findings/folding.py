"""Findings of one cause, shown as one: their names differ by one namespace or part of a frame."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import takewhile
from typing import TypeAlias

from rtron.vocabulary import Finding, FindingLevel
from rtron.wording import join_names

_Difference: TypeAlias = tuple[FindingLevel, bool, frozenset[tuple[str, ...]]]
"""The level, whether it is between namespaces, and what parts the two names."""


def fold(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return the findings as they are shown: the first of those with one cause tells of others."""
    return tuple(_folded(*group) for group in _groups(findings))


def folds(findings: Iterable[Finding]) -> dict[str, str]:
    """Return the id of the finding that tells of another, by the id of the other."""
    pairs = ((each.id, first.id) for first, *others in _groups(findings) for each in others)
    return {other: first for other, first in pairs if other != first}


def _groups(findings: Iterable[Finding]) -> Iterable[list[Finding]]:
    """Return the findings, those whose names differ alike together."""
    found: dict[object, list[Finding]] = {}
    for finding in findings:
        found.setdefault(_difference(finding) or finding.id, []).append(finding)
    return found.values()


def _difference(finding: Finding) -> _Difference | None:
    """Return what parts a name from what is meant; None where its own name does, too."""
    if not finding.meant:
        return None
    are_namespaces = finding.subject.startswith("/") and finding.meant.startswith("/")
    names = [
        name.split("/") if are_namespaces else re.split(r"([/_])", name)
        for name in (finding.subject, finding.meant)
    ]
    same = len(list(takewhile(_are_equal, zip(*map(reversed, names), strict=False))))
    heads = [name[: len(name) - same] for name in names]
    begin = len(list(takewhile(_are_equal, zip(*heads, strict=False))))
    parts = frozenset(tuple(name[begin:]) for name in heads)
    is_one_name = same > 0 or (begin > 0 and not are_namespaces)
    return (finding.level, are_namespaces, parts) if is_one_name else None


def _are_equal(pair: tuple[str, ...]) -> bool:
    one, other = pair
    return one == other


def _folded(first: Finding, *others: Finding) -> Finding:
    if not others:
        return first
    pairs = [f"{each.subject} from {each.meant}" for each in others]
    is_of_names = first.subject.startswith("/")
    return replace(
        first,
        cause=f"{first.cause}; the same parts {join_names(pairs)}",
        remedy="give the nodes one namespace, or write these names without a slash before them"
        if is_of_names
        else first.remedy,
        nodes=_union([each.nodes for each in (first, *others)]),
        topics=_union([each.topics for each in (first, *others)]),
        evidence=tuple(
            dict.fromkeys(place for each in (first, *others) for place in each.evidence)
        ),
    )


def _union(names: Sequence[Sequence[str]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for each in names for name in each))
