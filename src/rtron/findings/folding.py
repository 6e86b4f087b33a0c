"""Findings of one cause as one: all their names differ by one namespace, or one part of a frame."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from typing import TypeAlias

from rtron.vocabulary import Finding, FindingLevel
from rtron.wording import join_names

_Difference: TypeAlias = tuple[FindingLevel, bool, frozenset[tuple[str, ...]]]
"""The level, whether it is between namespaces, and what parts the two names."""


@dataclass(slots=True)
class _Groups:
    """Findings with what is meant, those of one difference or name together, the worst first."""

    _of: dict[object, list[Finding]] = field(default_factory=dict)

    def add(self, finding: Finding) -> list[Finding]:
        """Return the group of a finding, which is its last."""
        keys = list(_keys(finding)) or [finding.id]
        group = next((self._of[key] for key in keys if key in self._of), [])
        group.append(finding)
        self._of.update(dict.fromkeys(keys, group))
        return group


def fold(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Return the findings; the first of those with one cause tells of the others."""
    groups, found = _Groups(), list[list[Finding]]()
    for finding in findings:
        group = groups.add(finding)
        if len(group) == 1:
            found.append(group)
    return tuple(_folded(*group) for group in found)


def _keys(finding: Finding) -> Iterator[object]:
    """Yield what the findings of one cause share: the difference, and a name of one namespace."""
    difference = _difference(finding)
    if difference is not None:
        yield difference
        level, are_namespaces, _ = difference
        if are_namespaces:
            yield from ((level, name) for name in (finding.subject, finding.meant))


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
