"""Counts over the apps of a survey: of all, and of either ROS.

Sources: "Analysis of open-source robot apps" (section 3.3; `rtron.functions.app_categories` has
that table), section 7.1 (risks of the 110 apps), "Numbers of CNs in four complex robot apps"
(section 7.2) and "Processing time of potential risk discovery" (section 7.3). The graph of
functions is a picture without counts.
"""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import median
from types import MappingProxyType
from typing import TypeAlias

from rtron.functions.app_categories import CategoryCount, count_categories
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.survey.app_survey import AppResult, AppSurvey
from rtron.vocabulary import Domain, FunctionType, RiskKind

FunctionPair: TypeAlias = tuple[FunctionType, FunctionType]
"""Who publishes, and who subscribes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RiskCount:
    """How many apps have a kind of risk and how many such risks there are, and the app with most.

    `per_app` is the mean over all apps.
    """

    kind: RiskKind
    apps: int
    risks: int
    per_app: float
    most: int
    worst_app: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkCount:
    """In how many apps one function's nodes reach another's, and with which types in how many."""

    source: FunctionType
    target: FunctionType
    apps: int
    types: Mapping[str, int]


@dataclass(frozen=True)
class SurveyCounts:
    """The counts over some apps; those that could not be scanned are in `failed` alone."""

    results: Sequence[AppResult]

    @cached_property
    def surveys(self) -> Sequence[tuple[AppResult, AppSurvey]]:
        """The apps that were scanned."""
        return [(result, result.survey) for result in self.results if result.survey]

    @property
    def apps(self) -> int:
        """How many apps were scanned."""
        return len(self.surveys)

    @property
    def failed(self) -> Sequence[AppResult]:
        """The apps that could not be scanned."""
        return [result for result in self.results if not result.survey]

    @cached_property
    def categories(self) -> Sequence[CategoryCount]:
        """How many apps there are of each category of the paper."""
        return count_categories(survey.profile for _, survey in self.surveys)

    @cached_property
    def risks(self) -> Sequence[RiskCount]:
        """The counts of each kind of risk."""
        return [self._risk_count(kind) for kind in RiskKind]

    @cached_property
    def findings(self) -> Mapping[str, int]:
        """How many apps have a finding of each rule, the most frequent first."""
        counts = Counter(rule for _, survey in self.surveys for rule in survey.finding_counts)
        return dict(sorted(counts.items(), key=lambda each: (-each[1], each[0])))

    @cached_property
    def links(self) -> Mapping[FunctionPair, LinkCount]:
        """Which functions exchange messages, the pairs of most apps first; Others left out."""
        apps: Counter[FunctionPair] = Counter()
        types: defaultdict[FunctionPair, Counter[str]] = defaultdict(Counter)
        for _, survey in self.surveys:
            pairs = set()
            for pair, type in _linked_types(survey):
                types[pair][type] += 1
                pairs.add(pair)
            apps.update(pairs)
        order = list(FunctionType)
        ranked = sorted(
            apps, key=lambda each: (-apps[each], order.index(each[0]), order.index(each[1]))
        )
        return {
            pair: LinkCount(
                source=pair[0],
                target=pair[1],
                apps=apps[pair],
                types=dict(sorted(types[pair].items(), key=lambda each: (-each[1], each[0]))),
            )
            for pair in ranked
        }

    @cached_property
    def functions(self) -> Mapping[FunctionType, int]:
        """How many apps have a node of each function."""
        counts = Counter(each for _, survey in self.surveys for each in survey.profile.functions)
        return {function: counts[function] for function in FunctionType if counts[function]}

    def median_of(self, field: str) -> float:
        """Return the median over the apps of a number that a survey has."""
        return float(median([getattr(survey, field) for _, survey in self.surveys] or [0]))

    def _risk_count(self, kind: RiskKind) -> RiskCount:
        counts = [(survey.risks.get(kind, 0), result.app) for result, survey in self.surveys]
        most, worst = max(counts, default=(0, ""))
        risks = sum(number for number, _ in counts)
        return RiskCount(
            kind=kind,
            apps=sum(number > 0 for number, _ in counts),
            risks=risks,
            per_app=risks / (len(counts) or 1),
            most=most,
            worst_app=worst if most else "",
        )


def _linked_types(survey: AppSurvey) -> Iterator[tuple[FunctionPair, str]]:
    for link in survey.links:
        if Domain.OTHERS not in (DOMAIN_BY_TYPE[link.source], DOMAIN_BY_TYPE[link.target]):
            yield (link.source, link.target), link.type


def counts_by_ros(results: Sequence[AppResult]) -> Mapping[int, SurveyCounts]:
    """Return the counts over all apps, as 0, and over those of ROS 1 and of ROS 2."""
    by_ros = {ros: SurveyCounts([each for each in results if each.ros == ros]) for ros in (1, 2)}
    return {0: SurveyCounts(results), **by_ros}


RSR_APPS = 16
"""Apps that were looked at for RSR: 15 related to images, one to the maximal velocity."""
RSR_RISKS = 24
"""20 related to images, 4 to the maximal velocity."""
RISKS_OF_COMPLEX_APPS = 198


@dataclass(frozen=True, slots=True, kw_only=True)
class ComplexApp:
    """One of the paper's four complex apps: its size, and the coordination nodes that it needs."""

    name: str
    nodes: int
    topics: int
    grcn: Mapping[Domain, int]
    fps_monitor: int


def _complex_app(name: str, size: tuple[int, int], grcn: tuple[int, ...], fps: int) -> ComplexApp:
    domains = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
    return ComplexApp(
        name=name,
        nodes=size[0],
        topics=size[1],
        grcn=MappingProxyType(dict(zip(domains, grcn, strict=True))),
        fps_monitor=fps,
    )


COMPLEX_APPS = (
    _complex_app("Home", (21, 125), (8, 3, 1), 2),
    _complex_app("AutoRace", (25, 112), (16, 2, 4), 5),
    _complex_app("Apollo", (21, 39), (4, 1, 1), 3),
    _complex_app("Autoware", (38, 218), (11, 3, 2), 1),
)
"""Each has one RSRCN and one MSRCN besides."""
