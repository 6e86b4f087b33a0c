"""The risks of a report by kind, the worst first; mild ones in short."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rich.text import Text

from rtron.reports.text_layout import TextPage, heading, line, paragraph
from rtron.vocabulary import (
    Evidence,
    InteractionGraph,
    Risk,
    RiskKind,
    RiskReport,
    RiskRole,
    Severity,
)

SEVERITY_STYLE: Mapping[Severity, str] = {
    Severity.HIGH: "bold red",
    Severity.MEDIUM: "yellow",
    Severity.LOW: "cyan",
}
KIND_TITLE: Mapping[RiskKind, str] = {
    RiskKind.GR_ST: "several nodes publish one topic",
    RiskKind.GR_MT: "one node obeys several topics of one type",
    RiskKind.RSR: "the robot may move faster than it sees",
    RiskKind.MSR: "an action may be taken under the wrong event",
}
_LOCATIONS_SHOWN: Mapping[Severity, int] = {Severity.HIGH: 3, Severity.MEDIUM: 1, Severity.LOW: 0}
_INDENT = 10
MILDEST_LAST: tuple[Severity, ...] = tuple(reversed(Severity))


def worst_first(risk: Risk) -> int:
    """Return a sort key that puts high before medium before low."""
    return MILDEST_LAST.index(risk.severity)


def risk_list(report: RiskReport, page: TextPage) -> Iterator[Text]:
    """Yield the risks that have no drawing: each with its reason and where it was read."""
    for kind in RiskKind:
        risks = [risk for risk in report.risks if risk.kind is kind is not RiskKind.GR_ST]
        if risks:
            yield from heading(f"{kind}: {KIND_TITLE[kind]} ({len(risks)})")
        for risk in sorted(risks, key=worst_first):
            yield from _risk(risk, page)


def severity_mark(risk: Risk) -> tuple[str, str]:
    """Return the severity in its column and its style."""
    return f"{risk.severity:<8}", SEVERITY_STYLE[risk.severity]


def evidence_lines(risk: Risk, *, indent: int) -> Iterator[Text]:
    """Yield where a risk was read, more places the worse it is, and how many are left out."""
    shown = risk.evidence[: _LOCATIONS_SHOWN[risk.severity]]
    more = len(risk.evidence) - len(shown)
    for index, evidence in enumerate(shown, start=1):
        rest = f" and {more} more" if more and index == len(shown) else ""
        yield line((location(evidence) + rest, "dim"), indent=indent)


def location(evidence: Evidence) -> str:
    """Return `file:line`, which editors and terminals open."""
    return f"{evidence.file}:{evidence.line}" if evidence.line else evidence.file


def _risk(risk: Risk, page: TextPage) -> Iterator[Text]:
    yield line(severity_mark(risk), (risk.id, "bold"), ("  " + risk.domain, "dim"), indent=2)
    if risk.severity is Severity.LOW:
        return
    yield from paragraph(risk.reason, page, indent=_INDENT)
    yield from _unnamed(risk, page)
    yield from evidence_lines(risk, indent=_INDENT)


def _unnamed(risk: Risk, page: TextPage) -> Iterator[Text]:
    """Yield the nodes of each role where the reason does not name them all."""
    for role, nodes in risk.role_nodes.items():
        if not _names_all(risk.reason, nodes):
            yield from paragraph(f"{role}: {', '.join(nodes)}", page, indent=_INDENT)


def _names_all(reason: str, nodes: Sequence[str]) -> bool:
    words = {word.strip(",:;.") for word in reason.split()}
    return words.issuperset(nodes)


Edge = tuple[str, str]


@dataclass(frozen=True, slots=True)
class RiskMarks:
    """The risky topics, nodes and edges; an edge is (node, topic), whichever way it points."""

    single_topic: frozenset[Edge]
    multi_topic: frozenset[Edge]
    event_topics: frozenset[str]
    action_topics: frozenset[str]
    image_nodes: frozenset[str]
    max_vel_nodes: frozenset[str]


def risk_marks(graph: InteractionGraph, report: RiskReport) -> RiskMarks:
    """Return what each kind of risk touches."""
    by_kind = {kind: [r for r in report.risks if r.kind is kind] for kind in RiskKind}
    mission, robot = by_kind[RiskKind.MSR], by_kind[RiskKind.RSR]
    return RiskMarks(
        single_topic=_edges(graph, by_kind[RiskKind.GR_ST]),
        multi_topic=_edges(graph, by_kind[RiskKind.GR_MT]),
        event_topics=_published(graph, mission, RiskRole.EVENT),
        action_topics=_published(graph, mission, RiskRole.ACTION),
        image_nodes=_nodes(robot, RiskRole.IMAGE),
        max_vel_nodes=_nodes(robot, RiskRole.MAX_VEL),
    )


def _edges(graph: InteractionGraph, risks: Iterable[Risk]) -> frozenset[Edge]:
    """Return the edges between the risks' topics and their publishers and successors."""
    return frozenset(
        (endpoint.node, topic)
        for risk in risks
        for topic in risk.topics
        for endpoint in (*graph.publishers(topic), *graph.subscribers(topic))
        if endpoint.node in _concerned(risk)
    )


def _concerned(risk: Risk) -> frozenset[str]:
    return frozenset(risk.successors).union(*risk.role_nodes.values())


def _nodes(risks: Iterable[Risk], role: RiskRole) -> frozenset[str]:
    return frozenset(node for risk in risks for node in risk.role_nodes.get(role, ()))


def _published(graph: InteractionGraph, risks: Iterable[Risk], role: RiskRole) -> frozenset[str]:
    """Return the risks' topics that a node in `role` publishes."""
    return frozenset(
        topic
        for risk in risks
        for topic in risk.topics
        for endpoint in graph.publishers(topic)
        if endpoint.node in risk.role_nodes.get(role, ())
    )
