"""What a package's code tells of its function: rules over facts, `code.yaml`."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from typing import TYPE_CHECKING, TypeAlias

from rtron.functions.patterns.syntax_tree import matches_at
from rtron.functions.repository import load_package_yaml
from rtron.vocabulary import FunctionType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.classifier.result import InformationSource
    from rtron.functions.patterns.syntax_tree import PatternNode
    from rtron.functions.repository import SourcePackage
    from rtron.functions.text import Tokens

Facts: TypeAlias = frozenset[str]
"""Facts of a package, each a kind and a name: `depends joy`, `publishes sensor_msgs/Joy`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRule:
    """Tells a type where a package has one fact of each group of `has`, and none of `without`.

    A rule `is_of_repository` where it is about the facts of all packages together.
    """

    id: str
    type: FunctionType
    weight: float
    is_of_repository: bool
    has: tuple[tuple[str, ...], ...]
    without: tuple[tuple[str, ...], ...] = ()

    def match(self, facts: Facts) -> tuple[str, ...]:
        """Return the facts that fit, one for each group; none if the rule does not."""
        found = tuple(_first_match(facts, group) for group in self.has)
        excluded = any(_first_match(facts, group) for group in self.without)
        return found if all(found) and not excluded else ()


def package_facts(package: SourcePackage) -> Facts:
    """Return what is known of a package's code."""
    return package.code | {f"depends {name.replace('-', '_')}" for name in package.depends}


def match_code(facts: Facts, *, of_repository: bool = False) -> Iterator[CodeMatch]:
    """Yield the rules on packages, or those on repositories, that fit to facts of the code."""
    for rule in load_code_rules() if facts else ():
        if rule.is_of_repository is of_repository and (found := rule.match(facts)):
            yield CodeMatch(rule=rule, text=", ".join(found))


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeMatch:
    """A rule that fits, and the facts that it fits to, as text."""

    rule: CodeRule
    text: str


@cache
def load_code_rules() -> tuple[CodeRule, ...]:
    """Return every rule on code that RTron brings."""
    return tuple(
        CodeRule(
            id=entry["id"],
            type=FunctionType(entry["type"]),
            weight=entry["weight"],
            is_of_repository=entry.get("of") == "repository",
            has=tuple(map(_alternatives, entry["has"])),
            without=tuple(map(_alternatives, entry.get("without", ()))),
        )
        for entry in load_package_yaml("rtron.functions.rules", "code.yaml")["rules"]
    )


def _first_match(facts: Facts, group: Iterable[str]) -> str:
    """Return the first fact that a group of patterns names, "" if none does."""
    return next((found for pattern in group if (found := _find(facts, pattern))), "")


def _find(facts: Facts, pattern: str) -> str:
    if "*" not in pattern:
        return pattern if pattern in facts else ""
    return min((fact for fact in facts if fnmatchcase(fact, pattern)), default="")


def _alternatives(line: str) -> tuple[str, ...]:
    """Return the patterns of a line: `depends joy | wiimote` are two of a kind, and so on.

    An alternative of its own kind names it: `depends joy | imports pygame`.
    """
    patterns, kind = [], ""
    for alternative in line.split("|"):
        named, _, name = alternative.strip().rpartition(" ")
        kind = named or kind
        patterns.append(f"{kind} {name}")
    return tuple(patterns)


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionRule:
    """Tells a type where a pattern matches in a piece that counts, and no veto does.

    `weight` is from 1, a hint, over 3, enough alone, to 9: stronger than what else is there.
    `matches_at` and `excludes` are examples, which tests run.
    """

    id: str
    type: FunctionType
    weight: float
    patterns: tuple[PatternNode, ...]
    sources: frozenset[InformationSource]
    vetoes: tuple[PatternNode, ...] = ()
    matches: tuple[str, ...] = ()
    excludes: tuple[str, ...] = ()

    def matches_text(self, tokens: Tokens) -> bool:
        """Tell whether a pattern matches in a name or sentence, and no veto does."""
        return _matches_anywhere(self.patterns, tokens) and not self.is_vetoed(tokens)

    def is_vetoed(self, tokens: Tokens) -> bool:
        """Tell whether a veto matches anywhere in a name or sentence."""
        return _matches_anywhere(self.vetoes, tokens)


def _matches_anywhere(nodes: tuple[PatternNode, ...], tokens: Tokens) -> bool:
    starts = range(len(tokens.words))
    return any(matches_at(node, tokens, start) for node in nodes for start in starts)
