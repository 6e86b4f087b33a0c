"""What the page knows: the graph, its risks and the plan, with numbers in the place of names."""

from collections.abc import Iterable
from typing import Any

from rtron.reports.app.page_coordination import plan_data
from rtron.reports.app.page_ids import Numbers, numbers
from rtron.reports.app.risk_list import place
from rtron.reports.app.risk_marks import Paint, paint
from rtron.reports.app.risk_words import KIND_TITLE, worst_first
from rtron.reports.sanitize import neutral
from rtron.vocabulary import (
    Direction,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    Plan,
    Risk,
    RiskKind,
    RiskReport,
    Unresolved,
)


def page_data(graph: InteractionGraph, report: RiskReport, plan: Plan | None) -> Any:  # noqa: ANN401
    """Return all that the page shows as plain JSON, every text on one line and harmless."""
    names, colours = numbers(graph, report, plan), paint(graph, report)
    document = {
        "app": graph.app or "app",
        "ros": graph.ros,
        "kinds": {kind.value: KIND_TITLE[kind] for kind in RiskKind},
        "nodes": _nodes(graph, names, colours),
        "topics": _topics(graph, report, names, colours),
        "endpoints": [_endpoint(endpoint, names, colours) for endpoint in graph.endpoints],
        "services": [_side(names, s.node, s.name, s.type, "") for s in graph.services],
        "actions": [_side(names, a.node, a.name, a.type, a.role.value) for a in graph.actions],
        "risks": [_risk(risk, names) for risk in sorted(report.risks, key=worst_first)],
        "unresolved": [_unresolved(item) for item in graph.unresolved],
        "notRun": [list(item) for item in report.not_run.items()],
        "coordination": plan_data(plan, names) if plan else [],
    }
    return _harmless(document)


def _nodes(graph: InteractionGraph, names: Numbers, colours: Paint) -> list[dict[str, Any]]:
    known = {node.name: node for node in graph.nodes}
    return [_node(known.get(name, Node(name=name)), colours) for name in names.nodes]


def _node(node: Node, colours: Paint) -> dict[str, Any]:
    marks = {"image": colours.image_nodes, "max_vel": colours.max_vel_nodes}
    return {
        "name": node.name,
        "package": node.package,
        "executable": node.executable,
        "origin": node.origin,
        "trust": node.trust.value,
        "function": node.function.value if node.function else "",
        "domain": node.domain.value if node.domain else "",
        "marks": [mark for mark, nodes in marks.items() if node.name in nodes],
    }


def _topics(
    graph: InteractionGraph, report: RiskReport, names: Numbers, colours: Paint
) -> list[dict[str, Any]]:
    declared = {topic.name: topic.types for topic in graph.topics}
    marks = {"event": colours.event_topics, "action": colours.action_topics}
    classes = report.topic_classes
    return [
        {
            "name": name,
            "types": _types(graph, name, declared.get(name, ())),
            "domain": classes[name].domain.value if name in classes else "",
            "sharing": classes[name].sharing.value if name in classes else "",
            "marks": [mark for mark, topics in marks.items() if name in topics],
        }
        for name in names.topics
    ]


def _types(graph: InteractionGraph, topic: str, declared: Iterable[str]) -> list[str]:
    used = (e.type for e in (*graph.publishers(topic), *graph.subscribers(topic)))
    return [name for name in dict.fromkeys((*declared, *used)) if name]


def _endpoint(endpoint: Endpoint, names: Numbers, colours: Paint) -> dict[str, Any]:
    edge = (endpoint.node, endpoint.topic)
    marks = {RiskKind.GR_ST: colours.single_topic, RiskKind.GR_MT: colours.multi_topic}
    remapped = endpoint.declared_name not in ("", endpoint.topic)
    return {
        "node": names.nodes[endpoint.node],
        "topic": names.topics[endpoint.topic],
        "publishes": endpoint.direction is Direction.PUBLISH,
        "type": endpoint.type,
        "declared": endpoint.declared_name if remapped else "",
        "implicit": endpoint.implicit,
        "resolution": endpoint.resolution.value,
        "evidence": _places(endpoint.evidence),
        "marks": [kind.value for kind, edges in marks.items() if edge in edges],
    }


def _side(names: Numbers, node: str, name: str, type: str, role: str) -> dict[str, Any]:
    return {"node": names.nodes[node], "name": name, "type": type, "role": role}


def _risk(risk: Risk, names: Numbers) -> dict[str, Any]:
    return {
        "id": risk.id,
        "kind": risk.kind.value,
        "rule": risk.rule,
        "roles": [[role.value, names.of_nodes(nodes)] for role, nodes in risk.role_nodes.items()],
        "topics": names.of_topics(risk.topics),
        "successors": names.of_nodes(risk.successors),
        "type": risk.message_type,
        "domain": risk.domain.value,
        "severity": risk.severity.value,
        "reason": risk.reason,
        "evidence": _places(risk.evidence),
    }


def _unresolved(item: Unresolved) -> dict[str, Any]:
    return {"what": item.what, "why": item.why, "evidence": _places(item.evidence)}


def _places(evidence: Iterable[Evidence]) -> list[str]:
    return [place(item) for item in evidence]


def _harmless(value: Any) -> Any:  # noqa: ANN401 - plain JSON
    if isinstance(value, str):
        return neutral(value)
    if isinstance(value, dict):
        return {key: _harmless(inner) for key, inner in value.items()}
    return [_harmless(inner) for inner in value] if isinstance(value, list) else value
