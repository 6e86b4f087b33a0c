"""The paper's two tables, counted anew: repositories by type, and what decided each.

As in the paper a repository counts once for each of its functions. One that nothing decides has
none; it is counted as an Extension that a person has to look at, as half of those are in the paper
(106 of 206).

Source: "Table: Categorization of repos in the ROS platform" (section 3.1), where the 941 count as
1,135, since some have several functions; "Table: The number of successful identifications in 941
repos" (appendix A.2). Rates and shares are in per cent, as they are printed there.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

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


REPOSITORIES_BY_TYPE: Mapping[FunctionType, int] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: 84,
        FunctionType.LOCALIZATION: 35,
        FunctionType.MAPPING: 31,
        FunctionType.RECOGNITION: 50,
        FunctionType.PATH_PLANNING: 103,
        FunctionType.GOAL_PLANNER: 11,
        FunctionType.PATH_TRACKING: 68,
        FunctionType.TELEOPERATION: 30,
        FunctionType.SPEECH_GENERATION: 9,
        FunctionType.SWITCHER: 6,
        FunctionType.MOBILE: 38,
        FunctionType.MANIPULATOR: 37,
        FunctionType.SPEAKER: 6,
        FunctionType.SENSORS: 128,
        FunctionType.VISUALIZATION: 169,
        FunctionType.SUPPORT: 111,
        FunctionType.EXTENSION: 219,
    }
)

CLASSIFICATION_COUNTS: Mapping[FunctionType, ClassificationCounts] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: ClassificationCounts(name=18, manifest=41, readme=13, none=12),
        FunctionType.LOCALIZATION: ClassificationCounts(name=17, manifest=13, readme=3, none=2),
        FunctionType.MAPPING: ClassificationCounts(name=15, manifest=11, readme=4, none=1),
        FunctionType.RECOGNITION: ClassificationCounts(name=21, manifest=23, readme=4, none=2),
        FunctionType.PATH_PLANNING: ClassificationCounts(name=44, manifest=49, readme=5, none=5),
        FunctionType.GOAL_PLANNER: ClassificationCounts(name=5, manifest=4, readme=0, none=2),
        FunctionType.PATH_TRACKING: ClassificationCounts(name=8, manifest=37, readme=11, none=12),
        FunctionType.TELEOPERATION: ClassificationCounts(name=7, manifest=21, readme=1, none=1),
        FunctionType.SPEECH_GENERATION: ClassificationCounts(name=2, manifest=1, readme=5, none=1),
        FunctionType.SWITCHER: ClassificationCounts(name=3, manifest=2, readme=1, none=0),
        FunctionType.MOBILE: ClassificationCounts(name=2, manifest=26, readme=4, none=6),
        FunctionType.MANIPULATOR: ClassificationCounts(name=2, manifest=30, readme=2, none=3),
        FunctionType.SPEAKER: ClassificationCounts(name=0, manifest=0, readme=5, none=1),
        FunctionType.SENSORS: ClassificationCounts(name=10, manifest=77, readme=16, none=25),
        FunctionType.VISUALIZATION: ClassificationCounts(name=98, manifest=60, readme=11, none=0),
        FunctionType.SUPPORT: ClassificationCounts(name=14, manifest=45, readme=25, none=27),
        FunctionType.EXTENSION: ClassificationCounts(name=23, manifest=72, readme=18, none=106),
    }
)
FUNCTION_NODE_COUNTS = ClassificationCounts(name=154, manifest=335, readme=74, none=73)
"""The first 14 types together, those that are not of Others."""

AUTOMATION_BY_TYPE: Mapping[FunctionType, float] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: 85.71,
        FunctionType.LOCALIZATION: 94.29,
        FunctionType.MAPPING: 96.77,
        FunctionType.RECOGNITION: 96.00,
        FunctionType.PATH_PLANNING: 95.15,
        FunctionType.GOAL_PLANNER: 81.82,
        FunctionType.PATH_TRACKING: 82.35,
        FunctionType.TELEOPERATION: 96.67,
        FunctionType.SPEECH_GENERATION: 88.89,
        FunctionType.SWITCHER: 100.00,
        FunctionType.MOBILE: 84.21,
        FunctionType.MANIPULATOR: 91.89,
        FunctionType.SPEAKER: 83.33,
        FunctionType.SENSORS: 80.47,
        FunctionType.VISUALIZATION: 100.00,
        FunctionType.SUPPORT: 75.68,
        FunctionType.EXTENSION: 51.60,
    }
)
FUNCTION_NODE_AUTOMATION = 88.52
