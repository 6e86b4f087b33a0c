"""Every rule that matches anywhere in a repository, asked or not: what explains a class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.classifier.result import InformationSource
from rtron.functions.rules.code_rules import match_code, package_facts
from rtron.functions.rules.loader import load_rule_index
from rtron.functions.text import description_tokens, name_tokens, readme_tokens

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtron.functions.repository import SourcePackage, SourceRepository
    from rtron.functions.rules.code_rules import CodeMatch
    from rtron.functions.text import Tokens
    from rtron.vocabulary import FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleMatch:
    """A rule that matches on some words of a piece; one that is vetoed does not count.

    `package` is the package whose name or description it is, "" where it is the repository's own.
    """

    package: str
    source: InformationSource
    text: str
    rule: str
    type: FunctionType
    weight: float
    is_vetoed: bool


def trace_rules(repository: SourceRepository) -> tuple[RuleMatch, ...]:
    """Return what matches in a repository: its name, its packages' texts and code, its README.

    A rule that matches a piece several times is listed once for each text that it matches on.
    """
    matches = [*_matches_in(name_tokens(repository.name), InformationSource.NAME)]
    facts = frozenset[str]().union(*map(package_facts, repository.packages))
    matches += _code_matches(match_code(facts, of_repository=True))
    for package in repository.packages:
        matches += _matches_in_package(package)
    for tokens in readme_tokens(repository.readme):
        matches += _matches_in(tokens, InformationSource.README)
    return tuple(dict.fromkeys(matches))


def _matches_in_package(package: SourcePackage) -> Iterator[RuleMatch]:
    yield from _matches_in(name_tokens(package.name), InformationSource.NAME, package.name)
    for tokens in description_tokens(package.description):
        yield from _matches_in(tokens, InformationSource.MANIFEST, package.name)
    yield from _code_matches(match_code(package_facts(package)), package.name)


def _code_matches(matches: Iterable[CodeMatch], package: str = "") -> Iterator[RuleMatch]:
    for match in matches:
        yield RuleMatch(
            package=package,
            source=InformationSource.CODE,
            text=match.text,
            rule=match.rule.id,
            type=match.rule.type,
            weight=match.rule.weight,
            is_vetoed=False,
        )


def _matches_in(
    tokens: Tokens, source: InformationSource, package: str = ""
) -> Iterable[RuleMatch]:
    return (
        RuleMatch(
            package=package,
            source=source,
            text=" ".join(tokens.words[match.start : match.end]),
            rule=match.value.id,
            type=match.value.type,
            weight=match.value.weight,
            is_vetoed=match.value.is_vetoed(tokens),
        )
        for match in load_rule_index().find(tokens)
        if source in match.value.sources
    )
