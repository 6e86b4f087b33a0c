"""The paper's two tables, counted anew: repositories by type, and what decided each.

As in the paper a repository counts once for each of its functions. One that nothing decides has
none; it is counted as an Extension that a person has to look at, as half of those are in the paper
(106 of 206).
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rtron.functions.classifier.result import (
    Classification,
    DecisionSource,
    InformationSource,
    RuleEvidence,
)
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.vocabulary import Domain, FunctionType


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassificationCounts:
    """Numbers of repositories by what decided their type; `none`: a person must."""

    name: int = 0
    manifest: int = 0
    code: int = 0
    readme: int = 0
    none: int = 0

    @property
    def decided(self) -> int:
        """How many a rule decided."""
        return self.name + self.manifest + self.code + self.readme

    @property
    def total(self) -> int:
        """How many there are."""
        return self.decided + self.none

    @property
    def automation(self) -> float | None:
        """The share that a rule decided, from 0 to 1; None of none at all."""
        return self.decided / self.total if self.total else None

    def __add__(self, other: "ClassificationCounts") -> "ClassificationCounts":
        return ClassificationCounts(
            name=self.name + other.name,
            manifest=self.manifest + other.manifest,
            code=self.code + other.code,
            readme=self.readme + other.readme,
            none=self.none + other.none,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperTables:
    """How many repositories there are, how many are decided, and the tally of every type.

    `expected_right` is the share of all of them that is right as first, by how sure each is.
    """

    repositories: int
    decided: int
    expected_right: float | None
    types: Mapping[FunctionType, ClassificationCounts]


def build_tables(classifications: Iterable[Classification]) -> PaperTables:
    """Return the tables of some classifications."""
    all_classifications = list(classifications)
    counts = Counter(pair for each in all_classifications for pair in _counted_types(each))
    types = {
        type: ClassificationCounts(**{str(by): counts[type, by] for by in DecisionSource})
        for type in FunctionType
    }
    sure = [each.confidence for each in all_classifications if each.confidence is not None]
    return PaperTables(
        repositories=len(all_classifications),
        decided=sum(each.decided_by is not DecisionSource.NONE for each in all_classifications),
        expected_right=sum(sure) / len(sure) if sure else None,
        types=types,
    )


def sum_domains(
    types: Mapping[FunctionType, ClassificationCounts], domains: Iterable[Domain]
) -> ClassificationCounts:
    """Return the tallies of some domains' types together."""
    domain_set = set(domains)
    return sum(
        (types[type] for type in types if DOMAIN_BY_TYPE[type] in domain_set),
        ClassificationCounts(),
    )


def sum_function_nodes(types: Mapping[FunctionType, ClassificationCounts]) -> ClassificationCounts:
    """Return the tally of the types that are nodes of an interaction graph: all but Others."""
    return sum_domains(types, set(Domain) - {Domain.OTHERS})


def _counted_types(classification: Classification) -> Iterator[tuple[FunctionType, DecisionSource]]:
    for type in classification.functions:
        yield type, _decision_source(classification, type)


def _decision_source(classification: Classification, type: FunctionType) -> DecisionSource:
    """Return what decided a repository's type: of one that is not the primary, what told it first.

    A package's name stands in its manifest: only that of the repository counts as a name.
    """
    if type is classification.primary:
        return classification.decided_by
    pieces = {_effective_source(each) for each in classification.evidence if each.type is type}
    return next((by for by in DecisionSource if str(by) in pieces), classification.decided_by)


def _effective_source(evidence: RuleEvidence) -> InformationSource:
    named = evidence.source is InformationSource.NAME and evidence.package
    return InformationSource.MANIFEST if named else evidence.source
