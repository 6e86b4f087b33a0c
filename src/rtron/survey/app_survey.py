"""What a survey keeps of an app: numbers, its risks and findings, and who exchanges what."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

import rtron
from rtron.findings.folding import fold
from rtron.functions.app_categories import AppProfile, app_profile
from rtron.functions.interactions.typical_messages import is_informative
from rtron.survey.app_listing import AppToScan
from rtron.vocabulary import (
    CoordinationCount,
    Evidence,
    Finding,
    FindingLevel,
    FunctionType,
    InteractionGraph,
    Risk,
    RiskKind,
    Severity,
    normalise_type,
    with_goal_topics,
)
from rtron.workflows.scan import scan_graph, with_relative_evidence

MAX_LISTED = 30
"""Risks and findings of an app that are kept one by one, the worst; all are counted."""
MAX_NAMES = 8
"""Nodes or topics that are named of one of them."""
_OWN_FOLDER = f"{Path(rtron.__file__).parents[1]}/"
"""Models of ours are places, too, and are named from here."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedRisk:
    """A risk of an app: what it is, where, and between whom; `place` is a file and a line."""

    kind: RiskKind
    severity: Severity
    topics: tuple[str, ...]
    nodes: tuple[str, ...]
    place: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedFinding:
    """A finding of an app in one sentence."""

    rule: str
    severity: Severity
    summary: str
    place: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionLink:
    """One function's nodes publish a type on topics that another's subscribe, in one app."""

    source: FunctionType
    target: FunctionType
    type: str
    topics: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AppSurvey:
    """An app in numbers: its graph, its risks by kind, the coordination nodes they ask for.

    `finding_counts` are findings by rule without those for auditors, `unresolved` what the scan
    could not know. Of risks and findings the worst MAX_LISTED are listed.
    """

    nodes: int
    topics: int
    risks: Mapping[RiskKind, int]
    coordination_nodes: CoordinationCount
    profile: AppProfile
    unresolved: int
    finding_counts: Mapping[str, int]
    listed_risks: tuple[ListedRisk, ...] = ()
    listed_findings: tuple[ListedFinding, ...] = ()
    links: tuple[FunctionLink, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class AppResult:
    """What became of an app: its survey, or the reason why there is none; it took `seconds`.

    `is_final` tells that the reason lies in the app: to try again would change nothing.
    """

    app: str
    repository: str
    ros: int
    seconds: float
    survey: AppSurvey | None = None
    error: str = ""
    is_final: bool = True


RESULT_ADAPTER: TypeAdapter[AppResult] = TypeAdapter(AppResult)


def survey_app(app: AppToScan, graph: InteractionGraph) -> AppSurvey:
    """Return the numbers of an app's graph."""
    result = scan_graph(with_relative_evidence(graph, app.top))
    findings = [each for each in fold(result.findings) if each.level is not FindingLevel.AUDITOR]
    profile = app_profile(graph, app.name)
    return AppSurvey(
        nodes=len(graph.nodes),
        topics=len(graph.topics),
        risks=Counter(risk.kind for risk in result.report.risks),
        coordination_nodes=result.report.coordination_nodes,
        profile=profile,
        unresolved=len(graph.unresolved),
        finding_counts=Counter(finding.rule for finding in findings),
        listed_risks=tuple(_listed_risk(each, app.top) for each in _worst(result.report.risks)),
        listed_findings=tuple(_listed_finding(each, app.top) for each in findings[:MAX_LISTED]),
        links=tuple(function_links(graph, profile)),
    )


def _worst(risks: Sequence[Risk]) -> Sequence[Risk]:
    worst_last = list(Severity)
    return sorted(risks, key=lambda each: -worst_last.index(each.severity))[:MAX_LISTED]


def _listed_risk(risk: Risk, top: Path) -> ListedRisk:
    nodes = dict.fromkeys(name for names in risk.role_nodes.values() for name in names)
    return ListedRisk(
        kind=risk.kind,
        severity=risk.severity,
        topics=risk.topics[:MAX_NAMES],
        nodes=tuple(nodes)[:MAX_NAMES],
        place=_place(risk.evidence, top),
    )


def _listed_finding(finding: Finding, top: Path) -> ListedFinding:
    return ListedFinding(
        rule=finding.rule,
        severity=finding.severity,
        summary=finding.summary,
        place=_place(finding.evidence, top),
    )


def _place(evidence: Sequence[Evidence], top: Path) -> str:
    first = next((each for each in evidence if each.file), None)
    if first is None:
        return ""
    file = first.file.removeprefix(f"{top}/").removeprefix(_OWN_FOLDER)
    return f"{file}:{first.line}" if first.line else file


def function_links(graph: InteractionGraph, profile: AppProfile) -> Iterator[FunctionLink]:
    """Yield which functions exchange which types on which topics; goals of actions are topics.

    A node that hears itself, and types that every node has (logs, parameters), do not count.
    """
    functions: defaultdict[str, list[FunctionType]] = defaultdict(list)
    for function, nodes in profile.functions.items():
        for node in nodes:
            functions[node].append(function)
    topics: defaultdict[tuple[FunctionType, FunctionType, str], dict[str, None]]
    topics = defaultdict(dict)
    for topic, source, target, type in _connections(with_goal_topics(graph)):
        for published in functions[source]:
            for subscribed in functions[target]:
                topics[published, subscribed, type][topic] = None
    order = list(FunctionType)
    for key in sorted(topics, key=lambda each: (order.index(each[0]), order.index(each[1]), each)):
        source_function, target_function, type = key
        yield FunctionLink(
            source=source_function,
            target=target_function,
            type=type,
            topics=tuple(topics[key])[:MAX_NAMES],
        )


def _connections(graph: InteractionGraph) -> Iterator[tuple[str, str, str, str]]:
    """Yield a topic, a node that publishes it, another that subscribes it, and the type."""
    for name in dict.fromkeys(endpoint.topic for endpoint in graph.endpoints):
        for publisher in graph.publishers(name):
            type = normalise_type(publisher.type)
            if not is_informative(type):
                continue
            for subscriber in graph.subscribers(name):
                if subscriber.node != publisher.node:
                    yield name, publisher.node, subscriber.node, type
