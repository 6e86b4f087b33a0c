"""Which part of an interaction graph belongs to which risk, for drawing it in colour."""

from collections.abc import Iterable
from dataclasses import dataclass

from rtron.vocabulary import InteractionGraph, Risk, RiskKind, RiskReport, RiskRole

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
